"""Export of meshes as Wavefront OBJ text."""

import numpy as np

from oodscen_pybullet._meshes.atlas import nearest_swatches
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._types import Array, Ints


def wavefront(mesh: Mesh) -> str:
    """Return a mesh as OBJ text, with rows that are equal to within 0.1 mm written once."""
    corners = mesh.triangles.reshape(-1)
    points, point_rows = _distinct(mesh.vertices[corners])
    uvs, uv_rows = _distinct(nearest_swatches(mesh.uvs[corners]))
    normals, normal_rows = _distinct(mesh.normals[corners])
    lines = ["v {:.4f} {:.4f} {:.4f}".format(*row) for row in points]
    lines += ["vt {:.6f} {:.6f}".format(*row) for row in uvs]
    lines += ["vn {:.4f} {:.4f} {:.4f}".format(*row) for row in normals]
    faces = np.stack([point_rows, uv_rows, normal_rows], axis=1).reshape(-1, 9) + 1
    columns = faces.T.tolist()
    face = "f {}/{}/{} {}/{}/{} {}/{}/{}"
    lines += [face.format(*row) for row in zip(*columns, strict=True)]
    return "\n".join(lines) + "\n"


def _distinct(rows: Array) -> tuple[list[tuple[float, ...]], Ints]:
    """Return the rows that differ when rounded, and for each row the index of the one it equals."""
    scale = 1e4 if rows.shape[1] == 3 else 1e6
    groups = np.zeros(len(rows), np.int64)
    first = np.zeros(0, np.int64)
    for column in range(rows.shape[1]):
        whole = np.round(rows[:, column] * scale).astype(np.int64)
        low = int(whole.min())
        codes = groups * (int(whole.max()) - low + 1) + (whole - low)
        _, first, groups = np.unique(codes, return_index=True, return_inverse=True)
    return list(zip(*rows[first].T.tolist(), strict=True)), groups
