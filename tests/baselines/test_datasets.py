"""Files of the layouts of public data sets, with words of our own."""

import csv
import io
import json

import pytest

from oodscen.baselines import load_baseline
from oodscen.errors import DataError, UnknownComponent, UsageError


def _qa(question, answer):
    return {
        "Q": question,
        "A": answer,
        "C": None,
        "con_up": None,
        "con_down": None,
        "cluster": None,
        "layer": None,
    }


TAG = "<c1,CAM_FRONT,1.0,2.0>"


def _asked(looks, question, stage="perception"):
    frame = {"key_object_infos": {TAG: _object(looks)}, "QA": {stage: [_qa(question, "")]}}
    return json.dumps({"s": {"scene_description": "", "key_frames": {"f": frame}}})


def _object(looks):
    return {
        "Category": "Vehicle",
        "Status": None,
        "Visual_description": looks,
        "2d_bbox": [1.0, 2.0, 3.0, 4.0],
    }


DRIVELM = {
    "0a1b": {
        "scene_description": "The ego vehicle turns right after a tram.",
        "key_frames": {
            "77aa": {
                "key_object_infos": {
                    "<c1,CAM_FRONT,800.1,400.2>": _object("Grey van."),
                    "<c2,CAM_BACK,10.0,20.0>": _object("SUV."),
                    "<c3,CAM_BACK,11.0,21.0>": _object(None),
                },
                "QA": {
                    "perception": [
                        _qa("What is the status of object <c1,CAM_FRONT,800.1,400.2>?", "Parked."),
                        _qa("Is the object <c3,CAM_BACK,11.0,21.0> a tram?", "No."),
                    ],
                    "prediction": [
                        _qa("What comes first?", "<c2,CAM_BACK,10.0,20.0> comes first."),
                    ],
                    "planning": [_qa("What is safe?", "")],
                    "behavior": [_qa("Predict the behavior.", "The ego vehicle is slow.")],
                },
                "image_paths": {"CAM_FRONT": "../nuscenes/samples/CAM_FRONT/x.jpg"},
            },
        },
    },
    "0a1c": {"key_frames": {}},
}
NUSCENES = [
    {
        "token": "cc8c",
        "log_token": "7e25",
        "nbr_samples": 39,
        "first_sample_token": "ca9a",
        "last_sample_token": "ed5f",
        "name": "scene-9001",
        "description": description,
    }
    for description in ("Wait at crossing, bus left", "Night, follow a van")
]
TALK2CAR = {
    "commands": [
        {
            "scene_token": "4051",
            "sample_token": "2d4d",
            "translation": [-1.0, 2.0, 3.0],
            "size": [1.9, 4.7, 2.0],
            "rotation": ["-0.1", "-0.1", "-0.6", "0.6"],
            "command": "stop beside the lady with the umbrella. ",
            "obj_name": "human.pedestrian.adult",
            "box_token": "528d",
            "command_token": "7292",
            "2d_box": [260, 479, 191, 82],
            "t2c_img": "img_val_0.jpg",
        },
        {"scene_token": "4051", "sample_token": "2d4e", "command": "follow that bus"},
    ],
    "scene_tokens": ["4051"],
}
CITYFLOW = {
    "1ed5": {
        "frames": ["./train/S01/c001/img1/000001.jpg"],
        "boxes": [[1, 2, 3, 4]],
        "nl": ["A green van turns left.", "Green van turning."],
        "nl_other_views": ["A van waits at a light."],
    },
    "cd3b": {"nl": ["A blue car goes straight."], "nl_other_views": []},
}


def _bdd(*clips):
    columns = ["Input.Video"]
    for k in range(1, 16):
        columns += [f"Answer.{k}{name}" for name in ("start", "end", "action", "justification")]
    out = io.StringIO(newline="")
    writer = csv.writer(out)
    writer.writerow(columns)
    for clip in clips:
        cells = ["https://example.org/samples/a.mov"]
        for action, reason in clip:
            cells += ["0", "9", action, reason]
        writer.writerow(cells + [""] * (len(columns) - len(cells)))
    return out.getvalue()


BDD_X = _bdd(
    [
        ("The car stops", "because a tram passes."),
        ("The car is still. ", "The light is red, still"),
    ],
    [("The car turns, slowly.", "")],
    [],
)

READ = {
    "drivelm": (
        "v1_1_train_nus.json",
        json.dumps(DRIVELM),
        [
            "The ego vehicle turns right after a tram.",
            "What is the status of the grey van? Parked.",
            "Is the object a tram? No.",
            "What comes first? The SUV comes first.",
            "What is safe?",
            "Predict the behavior. The ego vehicle is slow.",
        ],
    ),
    "nuscenes": (
        "scene.json",
        json.dumps(NUSCENES),
        ["Wait at crossing, bus left", "Night, follow a van"],
    ),
    "talk2car": (
        "val_commands.json",
        json.dumps(TALK2CAR),
        ["stop beside the lady with the umbrella.", "follow that bus"],
    ),
    "bdd-x": (
        "BDD-X-Annotations_v1.csv",
        BDD_X,
        [
            "The car stops because a tram passes.",
            "The car is still. The light is red, still",
            "The car turns, slowly.",
        ],
    ),
    "cityflow-nl": (
        "train-tracks.json",
        json.dumps(CITYFLOW),
        [
            "A green van turns left.",
            "Green van turning.",
            "A van waits at a light.",
            "A blue car goes straight.",
        ],
    ),
}


@pytest.mark.parametrize("layout", READ)
@pytest.mark.parametrize("is_named", [True, False])
def test_each_data_set_is_read_and_recognised(tmp_path, layout, is_named):
    name, content, texts = READ[layout]
    (tmp_path / name).write_text(content, encoding="utf-8")
    baseline = load_baseline(tmp_path / name, layout=layout if is_named else "auto")
    assert list(baseline.texts) == texts
    assert baseline.name == name
    assert baseline.source.endswith(f", {name}")
    assert baseline.licence
    assert str(tmp_path) not in baseline.to_json()


@pytest.mark.parametrize(
    ("layout", "parts", "texts"),
    [
        ("drivelm", ["scene"], ["The ego vehicle turns right after a tram."]),
        ("drivelm", ["object"], ["Grey van.", "SUV."]),
        (
            "drivelm",
            ["answer"],
            ["Parked.", "No.", "The SUV comes first.", "The ego vehicle is slow."],
        ),
        ("bdd-x", ["justification"], ["because a tram passes.", "The light is red, still"]),
        ("cityflow-nl", ["other_view"], ["A van waits at a light."]),
    ],
)
def test_parts_are_chosen(tmp_path, layout, parts, texts):
    name, content, _ = READ[layout]
    (tmp_path / name).write_text(content, encoding="utf-8")
    assert list(load_baseline(tmp_path / name, parts=parts).texts) == texts


@pytest.mark.parametrize(
    ("looks", "question", "text"),
    [
        ("A black car.", "Where is {}?", "Where is a black car?"),
        ("AN SUV", "Where is {}?", "Where is an SUV?"),
        ("Two cars", "Where are the {}?", "Where are two cars?"),
        ("Two-wheeler.", "Where is {}?", "Where is the two-wheeler?"),
        ("Black car", "Is a {} here?", "Is the black car here?"),
        ("Black car", "Is an object {} here?", "Is the black car here?"),
        ("A8", "{} waits.", "The A8 waits."),
    ],
)
def test_the_description_of_an_object_takes_one_article(tmp_path, looks, question, text):
    (tmp_path / "v.json").write_text(_asked(looks, question.format(TAG)))
    assert load_baseline(tmp_path / "v.json", parts=["qa"]).texts == (text,)


@pytest.mark.parametrize(
    ("action", "reason", "text"),
    [
        ("The car stops!", "Because of rain", "The car stops! Because of rain"),
        ("The car stops!", "because of rain", "The car stops because of rain"),
        ("The car stops", "Rain falls.", "The car stops. Rain falls."),
        ("The  car\nstops. ", "for\ta bus", "The car stops for a bus"),
        ("The car stops.", "the light is red", "The car stops, the light is red"),
        ("The car stops", "today a bus waits", "The car stops, today a bus waits"),
        ("The car stops,", "The light is red.", "The car stops. The light is red."),
        ("The car waits;", "because of rain", "The car waits because of rain"),
    ],
)
def test_an_action_and_its_reason_are_one_text(tmp_path, action, reason, text):
    (tmp_path / "v.csv").write_text(_bdd([(action, reason)]), newline="")
    assert load_baseline(tmp_path / "v.csv").texts == (text,)


def test_a_reason_without_an_action_is_a_justification_and_no_sentence(tmp_path):
    (tmp_path / "v.csv").write_text(_bdd([("", "It rains."), ("The car stops.", "")]), newline="")
    assert load_baseline(tmp_path / "v.csv", parts=["justification"]).texts == ("It rains.",)
    assert load_baseline(tmp_path / "v.csv").texts == ("The car stops.",)


@pytest.mark.parametrize("layout", ["auto", "bdd-x"])
@pytest.mark.parametrize("column", ["Answer.1action", "Answer.2justification"])
def test_no_column_of_bdd_x_may_be_there_twice(tmp_path, layout, column):
    header = "Input.Video,Answer.1action,Answer.2action,Answer.2justification"
    (tmp_path / "v.csv").write_text(f"{header},{column}\nx,A.,B.,C.,D.\n")
    with pytest.raises(DataError, match=f"line 1: has two columns '{column}'"):
        load_baseline(tmp_path / "v.csv", layout=layout)


def test_a_header_that_is_no_csv_lacks_no_column(tmp_path):
    (tmp_path / "v.csv").write_text('Input.Video,"Answer.1action\na')
    with pytest.raises(DataError, match="line 1: is not CSV: a quote is not closed"):
        load_baseline(tmp_path / "v.csv", layout="bdd-x")


def test_a_key_that_occurs_twice_is_never_a_data_set(tmp_path):
    scene = '{"scene_description": "x", "key_frames": {}}'
    (tmp_path / "v.json").write_text(f'{{"s": {scene}, "s": {scene}}}')
    with pytest.raises(DataError, match="'s' occurs twice"):
        load_baseline(tmp_path / "v.json")


@pytest.mark.parametrize("layout", ["auto", "cityflow-nl"])
def test_queries_of_2021_are_bare_lists(tmp_path, layout):
    key = "4e22368e-8180-46a5-b5a9-2af2f2a53ba{}"
    queries = {key.format(1): ["a car", "one car"], key.format(2): ["a van"]}
    (tmp_path / "test-queries.json").write_text(json.dumps(queries))
    baseline = load_baseline(tmp_path / "test-queries.json", layout=layout)
    assert baseline.texts == ("a car", "one car", "a van")


def test_equal_texts_can_be_dropped_and_a_licence_be_named(tmp_path):
    (tmp_path / "scene.json").write_text(json.dumps(NUSCENES * 2))
    assert len(load_baseline(tmp_path / "scene.json")) == 4
    baseline = load_baseline(tmp_path / "scene.json", distinct=True, licence="own agreement")
    assert (len(baseline), baseline.licence) == (2, "own agreement")


@pytest.mark.parametrize(
    ("layout", "content", "places"),
    [
        ("drivelm", "[]", [""]),
        ("drivelm", "{", [""]),
        ("drivelm", '{"s": {"scene_description": "x"}}', ["s.key_frames"]),
        ("drivelm", '{"s": 3, "t": {"key_frames": [1]}}', ["s", "t.key_frames"]),
        (
            "drivelm",
            json.dumps(
                {
                    "s": {
                        "scene_description": 4,
                        "key_frames": {
                            "f": {"QA": {"perception": [{"Q": "?"}, _qa(5, "x")], "behavior": {}}},
                            "g": {"QA": [], "key_object_infos": {"<c1>": None}},
                        },
                    }
                }
            ),
            [
                "s.scene_description",
                "s.key_frames.f.QA.perception[0]",
                "s.key_frames.f.QA.perception[1].Q",
                "s.key_frames.f.QA.behavior",
                "s.key_frames.g.key_object_infos.<c1>",
                "s.key_frames.g.QA",
            ],
        ),
        ("nuscenes", "{}", [""]),
        ("nuscenes", '[{"description": "a"}, {"name": "b"}, 5]', ["[1]", "[2]"]),
        ("nuscenes", '[{"description": 7}]', ["[0].description"]),
        ("nuscenes", '[{"description": " "}]', [""]),
        ("nuscenes", '[{"description": "a"}, {"description": "b\\u0000"}]', ["[1].description"]),
        ("drivelm", '{"s": {"key_frames": {}}, "s": {"key_frames": {}}}', [""]),
        ("drivelm", _asked("", ""), [""]),
        ("drivelm", _asked("", "", stage="Perception"), ["s.key_frames.f.QA.Perception"]),
        ("talk2car", '{"scene_tokens": []}', ["commands"]),
        ("talk2car", '{"commands": [{"command": "a"}, {}]}', ["commands[1]"]),
        ("bdd-x", "text\na car\n", ["line 1"]),
        ("bdd-x", "", ["line 1"]),
        ("bdd-x", _bdd(), [""]),
        ("cityflow-nl", "[1]", [""]),
        ("cityflow-nl", '{"t": {"frames": []}, "u": {"nl": "a"}}', ["t", "u.nl"]),
        ("cityflow-nl", '{"t": ["a", 1]}', ["t.nl[1]"]),
    ],
)
def test_every_fault_is_found_with_its_place(tmp_path, layout, content, places):
    path = tmp_path / "file"
    path.write_text(content)
    with pytest.raises(DataError) as caught:
        load_baseline(path, layout=layout)
    assert [issue.path for issue in caught.value.issues] == places
    assert caught.value.source == str(path)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.json", '["a car"]'),
        ("a.json", '[{"text": "a car", "description": "x"}]'),
        ("a.json", '{"text": "a car"}'),
        ("a.csv", "text\na car\n"),
        ("a.txt", "a car"),
    ],
)
def test_plain_files_are_not_taken_for_a_data_set(tmp_path, name, content):
    (tmp_path / name).write_text(content)
    for layout in ("auto", "plain"):
        baseline = load_baseline(tmp_path / name, layout=layout)
        assert (baseline.texts, baseline.source, baseline.licence) == (("a car",), name, "")


def test_unknown_layouts_and_parts_are_named(tmp_path):
    (tmp_path / "scene.json").write_text(json.dumps(NUSCENES))
    (tmp_path / "a.txt").write_text("a car")
    with pytest.raises(UnknownComponent) as caught:
        load_baseline(tmp_path / "a.txt", layout="nuscene")
    assert caught.value.matches == ("nuscenes",)
    with pytest.raises(UnknownComponent) as caught:
        load_baseline(tmp_path / "scene.json", parts=["scenes"])
    assert caught.value.matches == ("scene",)
    with pytest.raises(UsageError):
        load_baseline(tmp_path / "scene.json", parts=[])
    with pytest.raises(UsageError):
        load_baseline(tmp_path / "a.txt", parts=["scene"])


def test_a_missing_file_and_other_bytes_are_refused(tmp_path):
    (tmp_path / "scene.json").write_bytes(b"\xff\xfe[]")
    for name in ("scene.json", "none.json"):
        for layout in ("auto", "nuscenes"):
            with pytest.raises(DataError):
                load_baseline(tmp_path / name, layout=layout)
