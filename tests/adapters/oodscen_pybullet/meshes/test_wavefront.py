import numpy as np
import pytest
from oodscen_pybullet._meshes import asset_mesh
from oodscen_pybullet._meshes.wavefront import wavefront


@pytest.mark.parametrize("asset", ["car", "deer", "road_closed_sign"])
def test_the_text_holds_every_corner_of_the_mesh(asset: str) -> None:
    mesh = asset_mesh(asset)
    rows: dict[str, list[list[float]]] = {"v": [], "vt": [], "vn": []}
    corners = []
    for line in wavefront(mesh).splitlines():
        kind, *values = line.split()
        if kind == "f":
            corners += [[int(index) - 1 for index in value.split("/")] for value in values]
        else:
            rows[kind].append([float(value) for value in values])
    which = np.array(corners)
    order = mesh.triangles.reshape(-1)
    for column, (kind, expected) in enumerate(
        (("v", mesh.vertices), ("vt", mesh.uvs), ("vn", mesh.normals))
    ):
        assert np.array(rows[kind])[which[:, column]] == pytest.approx(expected[order], abs=1e-4)
    assert len(rows["v"]) < len(order)
