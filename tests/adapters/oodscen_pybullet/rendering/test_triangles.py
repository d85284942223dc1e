import itertools

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._meshes import asset_ids, asset_mesh
from oodscen_pybullet._meshes.atlas import REGIONS, draw_atlas
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._rendering.triangles import CHUNK, LEVELS, Triangles, textures


@given(st.sampled_from(asset_ids()), st.booleans())
def test_nothing_is_lost_and_everything_is_inside_its_sphere(asset: str, is_chunked: bool) -> None:
    mesh = asset_mesh(asset)
    some = Triangles.of(mesh, draw_atlas(), is_chunked=is_chunked)
    assert 0 < len(some.corners) <= len(mesh.triangles)
    assert some.spans[0, 0] == 0
    assert some.spans[-1, 1] == len(some.corners)
    assert (some.spans[1:, 0] == some.spans[:-1, 1]).all()
    places = np.empty((len(some.corners), 3, 3))
    for (start, end, _), place, sphere in zip(some.spans, some.places, some.spheres, strict=True):
        assert not is_chunked or end - start <= CHUNK
        points = some.corners[start:end, :, :3].astype(float)
        away = points - sphere[:3]
        assert (away**2).sum(axis=2).max() <= float(sphere[3]) ** 2
        places[start:end] = points + place[:3]
    low, high = mesh.bounds
    assert abs(places.min(axis=(0, 1)) - low).max() < 1e-4
    assert abs(places.max(axis=(0, 1)) - high).max() < 1e-4


def test_joining_keeps_every_chunk() -> None:
    atlas = draw_atlas()
    parts = [Triangles.of(asset_mesh(name), atlas, is_chunked=False) for name in ("cone", "cow")]
    both = Triangles.joined(parts)
    assert both.spans.tolist() == [
        [0, len(parts[0].corners), -1],
        [len(parts[0].corners), len(both.corners), -1],
    ]
    assert np.array_equal(both.planes, np.concatenate([part.planes for part in parts]))


def test_colours_and_textures_are_told_apart() -> None:
    square = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    mesh = MeshBuilder().polygon(square, "red").textured_quad(square, "limit").build()
    some = Triangles.of(mesh, draw_atlas(), is_chunked=False)
    limit = list(REGIONS).index("limit")
    assert some.regions.tolist() == [-1, -1, limit, limit]
    assert some.colours[0].tolist() == [186.0, 28.0, 34.0]
    width, height = REGIONS["limit"][2:]
    texels = some.corners[2:, :, 6:]
    assert texels.min() == 0.5
    assert texels.max(axis=(0, 1)).tolist() == [width - 0.5, height - 0.5]


def test_textures_halve_and_keep_their_mean() -> None:
    sheet = textures()
    assert sheet.sizes.shape == (len(REGIONS), LEVELS, 3)
    for index, (_, _, width, height) in enumerate(REGIONS.values()):
        sizes = sheet.sizes[index].tolist()
        assert sizes[0][1:] == [width, height]
        assert all(2 * b[1] >= a[1] > b[1] or a[1] == 1 for a, b in itertools.pairwise(sizes))
        if width == height:
            means = [
                float((image[:h, :w] & np.uint64(0xFF)).mean())
                for start, w, h in sizes[:5]
                for image in [sheet.texels[start : start + (w + 1) * (h + 1)].reshape(h + 1, w + 1)]
            ]
            assert max(means) - min(means) < 6.0
