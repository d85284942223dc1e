import pytest

from oodscen.errors import OodscenError, SceneError, UsageError
from oodscen.interchange._writing.scenario import to_openscenario
from oodscen.testing import example_scene
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE


def test_what_cannot_be_written_is_named(tmp_path):
    written = example_scene().to_openscenario(FLAT_CATALOGUE)
    (tmp_path / "file").write_text("")
    for folder in (tmp_path / "file", tmp_path / "file" / "x"):
        with pytest.raises(OodscenError, match="cannot write"):
            written.save(folder)


def test_an_id_leads_out_of_no_folder(tmp_path):
    scene = example_scene().model_copy(update={"id": "../evil"})
    with pytest.raises(SceneError, match="id: "):
        scene.to_openscenario(FLAT_CATALOGUE)
    with pytest.raises(UsageError, match="name of a file"):
        to_openscenario(scene, FLAT_CATALOGUE).save(tmp_path / "in")
    assert list(tmp_path.iterdir()) == []
