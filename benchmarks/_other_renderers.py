"""Other renderers that draw the same triangles from the same camera, for `render.py`.

Each takes triangles with normals and texture coordinates, and returns colours, [height, width, 3] uint8,
in main memory; one sample per pixel, one light, no shadows. A class raises its library's own exception
where it cannot draw without a display.
"""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from oodscen_pybullet._meshes import Mesh
from oodscen_pybullet._meshes.atlas import draw_atlas
from oodscen_pybullet._rendering.appearance import Look, mesh_of
from oodscen_pybullet._rendering.view import FAR_M, NEAR_M, CameraView

from oodscen.numerics import _exact as exact

F32 = NDArray[np.float32]
U8 = NDArray[np.uint8]
Pose = tuple[float, float, float, float]


@dataclass(frozen=True, eq=False)
class Soup:
    """Triangles in no particular order."""

    points: F32
    """[3 n, 3] m, the corners of each triangle in sequence."""
    normals: F32
    """[3 n, 3]"""
    uvs: F32
    """[3 n, 2] texture coordinates from the lower left."""
    atlas: U8
    """[m, m, 3] texture, top row first."""


class Drawing(Protocol):
    """A renderer that holds a set of triangles."""

    def draw(self) -> U8:
        """Return the picture."""
        ...

    def close(self) -> None:
        """Release all resources."""


def soup_of(meshes: Sequence[Mesh], looks: Sequence[Look], poses: Sequence[Pose]) -> Soup:
    """Return scenery and actors as triangles in world coordinates."""
    bodies = [(mesh, (0.0, 0.0, 0.0, 0.0)) for mesh in meshes]
    bodies += [(mesh_of(look), pose) for look, pose in zip(looks, poses, strict=True)]
    points, normals, uvs = [], [], []
    for mesh, (x, y, z, yaw) in bodies:
        sine, cosine = exact.sincos(yaw)
        turn = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
        order = mesh.triangles.reshape(-1)
        points.append(mesh.vertices[order] @ turn + (x, y, z))
        normals.append(mesh.normals[order] @ turn)
        uvs.append(mesh.uvs[order])
    parts = (np.concatenate(rows).astype(np.float32) for rows in (points, normals, uvs))
    return Soup(*parts, atlas=draw_atlas())


class ModernGL:
    """moderngl on a standalone EGL context, which is llvmpipe on machines without a GPU."""

    _VERTEX = """
    #version 330
    uniform mat4 view, projection;
    in vec3 point; in vec3 normal; in vec2 place;
    out vec3 n; out vec2 at;
    void main() { n = normal; at = place; gl_Position = projection * view * vec4(point, 1.0); }
    """
    _FRAGMENT = """
    #version 330
    uniform sampler2D atlas; uniform vec3 sun;
    in vec3 n; in vec2 at;
    out vec4 colour;
    void main() {
        float light = 0.6 + 0.4 * max(dot(normalize(n), sun), 0.0);
        colour = vec4(texture(atlas, at).rgb * light, 1.0);
    }
    """

    def __init__(self, soup: Soup, view: CameraView) -> None:
        import moderngl

        self._context = moderngl.create_context(standalone=True, backend="egl", require=330)
        self.name = str(self._context.info["GL_RENDERER"])
        size = (view.width, view.height)
        program = self._context.program(self._VERTEX, self._FRAGMENT)
        rows = np.concatenate([soup.points, soup.normals, soup.uvs], axis=1).astype(np.float32)
        buffer = self._context.buffer(rows.tobytes())
        self._mesh = self._context.vertex_array(
            program, [(buffer, "3f 3f 2f", "point", "normal", "place")]
        )
        texture = self._context.texture(
            soup.atlas.shape[1::-1], 3, np.ascontiguousarray(soup.atlas[::-1]).tobytes()
        )
        texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        texture.use(0)
        program["view"].write(np.array(view.view_matrix(), np.float32).tobytes())
        matrix = view.projection_matrix(samples_corners=False)
        program["projection"].write(np.array(matrix, np.float32).tobytes())
        program["sun"].value = (-0.6, 0.48, 0.64)
        self._target = self._context.framebuffer(
            [self._context.renderbuffer(size)], self._context.depth_renderbuffer(size)
        )
        self._context.enable(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        self._shape = (view.height, view.width, 3)

    def draw(self) -> U8:
        """Return the picture."""
        self._target.use()
        self._target.clear(0.6, 0.7, 0.9, 1.0)
        self._mesh.render()
        pixels = np.frombuffer(self._target.read(components=3, alignment=1), np.uint8)
        return pixels.reshape(self._shape)[::-1]

    def close(self) -> None:
        """Release all resources."""
        self._context.release()


class MuJoCo:
    """MuJoCo's offscreen renderer, on EGL."""

    name = "EGL"

    def __init__(self, soup: Soup, view: CameraView) -> None:
        os.environ.setdefault("MUJOCO_GL", "egl")
        import mujoco

        spec = mujoco.MjSpec()
        spec.visual.global_.offwidth, spec.visual.global_.offheight = view.width, view.height
        spec.visual.quality.offsamples = 0
        spec.visual.quality.shadowsize = 0
        spec.visual.map.znear, spec.visual.map.zfar = NEAR_M, FAR_M
        spec.visual.headlight.ambient = (0.6, 0.6, 0.6)
        spec.visual.headlight.diffuse = spec.visual.headlight.specular = (0.0, 0.0, 0.0)
        spec.stat.extent, spec.stat.center = 1.0, (0.0, 0.0, 0.0)
        side = soup.atlas.shape[0]
        spec.add_texture(
            name="atlas", type=mujoco.mjtTexture.mjTEXTURE_2D, width=side, height=side, nchannel=3,
            data=soup.atlas[::-1].ravel().tolist(),
        )  # fmt: skip
        material = spec.add_material(name="paint", specular=0.0)
        material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "atlas"
        corners = 3 * 20_000
        for first in range(0, len(soup.points), corners):
            some = slice(first, first + corners)
            points = soup.points[some] - np.array(view.eye, np.float32)
            faces = np.arange(len(points), dtype=np.int32)
            spec.add_mesh(
                name=f"part{first}", uservert=points.ravel(), usernormal=soup.normals[some].ravel(),
                usertexcoord=soup.uvs[some].ravel(), userface=faces, userfacenormal=faces,
                userfacetexcoord=faces, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
            )  # fmt: skip
            spec.worldbody.add_geom(
                type=mujoco.mjtGeom.mjGEOM_MESH, meshname=f"part{first}", material="paint",
                contype=0, conaffinity=0,
            )  # fmt: skip
        height = view.height / view.focal / 2
        spec.worldbody.add_camera(
            name="dash",
            pos=(0.0, 0.0, 0.0),
            fovy=float(np.degrees(2 * np.arctan(height))),
            quat=_quaternion(mujoco, view),
        )
        spec.worldbody.add_light(
            type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, dir=(0.6, -0.48, -0.64), castshadow=False
        )
        self._model = spec.compile()
        data = mujoco.MjData(self._model)
        mujoco.mj_forward(self._model, data)
        self._renderer = mujoco.Renderer(self._model, view.height, view.width)
        self._renderer.update_scene(data, camera="dash")

    def draw(self) -> U8:
        """Return the picture."""
        pixels: U8 = self._renderer.render()
        return pixels

    def close(self) -> None:
        """Release all resources."""
        self._renderer.close()


def _quaternion(mujoco: Any, view: CameraView) -> NDArray[np.float64]:
    """Return the rotation of a camera that looks along its negative z."""
    turn = np.array([view.right, view.up, [-part for part in view.forward]]).T
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(turn).ravel())
    return quaternion


class Panda3D:
    """Panda3D, offscreen: OpenGL where it works without a display, otherwise Panda3D's software renderer."""

    def __init__(self, soup: Soup, view: CameraView) -> None:
        from panda3d import core

        core.load_prc_file_data("", "window-type offscreen\naudio-library-name null")
        core.load_prc_file_data("", "notify-level error\nsync-video false\ntextures-power-2 none")
        self._engine = core.GraphicsEngine()
        pipe, self.name = _pipe(core)
        wanted = core.FrameBufferProperties()
        wanted.set_rgb_color(True)
        wanted.set_rgba_bits(8, 8, 8, 8)
        wanted.set_depth_bits(24)
        window = core.WindowProperties(size=(view.width, view.height))
        self._buffer = self._engine.make_output(
            pipe, "buffer", 0, wanted, window, core.GraphicsPipe.BF_refuse_window
        )
        if self._buffer is None:
            raise RuntimeError(f"Panda3D opens no buffer by {self.name}")
        self._picture = core.Texture()
        self._buffer.add_render_texture(self._picture, core.GraphicsOutput.RTM_copy_ram)
        self._buffer.set_clear_color((0.6, 0.7, 0.9, 1.0))
        root = core.NodePath("root")
        shape = core.GeomVertexFormat.get_v3n3t2()
        data = core.GeomVertexData("soup", shape, core.Geom.UH_static)
        rows = np.concatenate([soup.points, soup.normals, soup.uvs], axis=1).astype(np.float32)
        data.unclean_set_num_rows(len(rows))
        memoryview(data.modify_array(0)).cast("B")[:] = rows.tobytes()
        node = core.GeomNode("soup")
        for first in range(0, len(rows), 3 * 20_000):
            triangles = core.GeomTriangles(core.Geom.UH_static)
            triangles.add_consecutive_vertices(first, min(3 * 20_000, len(rows) - first))
            geometry = core.Geom(data)
            geometry.add_primitive(triangles)
            node.add_geom(geometry)
        path = root.attach_new_node(node)
        atlas = core.Texture()
        atlas.setup_2d_texture(
            *soup.atlas.shape[1::-1], core.Texture.T_unsigned_byte, core.Texture.F_rgb
        )
        atlas.set_ram_image(np.ascontiguousarray(soup.atlas[::-1, :, ::-1]).tobytes())
        path.set_texture(atlas)
        for light, colour in ((core.AmbientLight("sky"), 0.6), (core.DirectionalLight("sun"), 0.4)):
            light.set_color((colour, colour, colour, 1.0))
            at = root.attach_new_node(light)
            if isinstance(light, core.DirectionalLight):
                light.set_direction((0.6, -0.48, -0.64))
            root.set_light(at)
        lens = core.PerspectiveLens()
        lens.set_film_size(view.width, view.height)
        lens.set_focal_length(view.focal)
        lens.set_near_far(NEAR_M, FAR_M)
        eye = root.attach_new_node(core.Camera("dash", lens))
        eye.set_pos(*view.eye)
        ahead = [a + b for a, b in zip(view.eye, view.forward, strict=True)]
        eye.look_at(core.Point3(*ahead), core.Vec3(*view.up))
        self._buffer.make_display_region().set_camera(eye)
        self._root, self._shape = root, (view.height, view.width, 4)

    def draw(self) -> U8:
        """Return the picture."""
        self._engine.render_frame()
        pixels = np.frombuffer(self._picture.get_ram_image_as("RGBA"), np.uint8)
        return pixels.reshape(self._shape)[::-1, :, :3]

    def close(self) -> None:
        """Release all resources."""
        self._engine.remove_all_windows()


def _pipe(core: Any) -> tuple[Any, str]:
    """Return a graphics pipe that needs no display, and its name."""
    pipes = core.GraphicsPipeSelection.get_global_ptr()
    for module in ("p3headlessgl", "p3tinydisplay"):
        pipe = pipes.make_module_pipe(module)
        if pipe is not None:
            return pipe, module
    raise RuntimeError("Panda3D has no way of drawing without a display")


RENDERERS: dict[str, tuple[str, type[Drawing]]] = {
    "moderngl": ("moderngl", ModernGL),
    "mujoco": ("MuJoCo", MuJoCo),
    "panda3d": ("Panda3D", Panda3D),
}
"""Required module, display name, and the class that draws with it."""
