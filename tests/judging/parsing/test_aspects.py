"""Aspects and confidences are read from JSON, labelled lines and short prose; "nothing" is no aspect."""

import json

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from oodscen.judging._parsing import Detected, names_nothing, read_aspect, read_named_aspect
from oodscen.judging._parsing.aspects import LONGEST_ASPECT
from oodscen.judging._parsing.confidence import probability


@pytest.mark.parametrize(
    ("said", "found"),
    [
        ('{"is_ood": true, "aspect": "a deer", "confidence": 0.9}', Detected(True, "a deer", 0.9)),
        ('{"is_ood": "No", "aspect": "none", "confidence": "80%"}', Detected(False, "", 0.8)),
        ('{"is_ood": true, "aspect": "a deer", "confidence": 7}', Detected(True, "a deer")),
        ("is_ood: true\nconfidence: 0.9\naspect: a deer", Detected(True, "a deer", 0.9)),
        ("Yes, a deer. Confidence: 80%", Detected(True, "a deer", 0.8)),
        ("Yes, a deer. Confidence: 0,8", Detected(True, "a deer", 0.8)),
        ("Yes, a deer. Confidence: 0.8O", None),
        ("Yes, a deer. Confidence: 0.8.1", None),
        ("No, nothing unusual. I am 70% sure.", Detected(False, "", 0.7)),
        ("Nothing is out of the ordinary.", Detected(False)),
        ("Yes. Confidence: 0.8. Confidence: 0.6.", Detected(True)),
        ("Yes. " + "The road is wet and dark. " * 20, None),
        ('{"is_ood": true, "is_ood": false}', None),
        ("OOD: yes\nOOD: no", None),
        ("Yes, the road is ordinary.", None),
        ("No, a deer.", None),
        ("Yes. 95%", Detected(True)),
        ("Yes, with 80% confidence: a cow", Detected(True, "a cow", 0.8)),
        ("Yes. Aspect: a deer. Confidence: 80%", Detected(True, "a deer", 0.8)),
        ("Yes. Aspect: a cow (0.9)", Detected(True, "a cow", 0.9)),
        ("Is anything out of the ordinary? Yes: thick fog.", Detected(True, "thick fog")),
        ("Is it unusual? No. Is it OOD? Yes.", None),
        ("Is the scene not unusual? No", None),
        ('{"is_ood": true, "aspect": "<the thing>"}', None),
        ('{"is_ood": true, "aspect": "<the thing>", "what": "a cow"}', Detected(True, "a cow")),
        ('{"is_ood": true, "aspect": "a cow", "what": "a fire"}', None),
        ('{"is_ood": true, "aspect": "a cow", "what": "a cow"}', Detected(True, "a cow")),
        ('{"is_ood": false, "aspect": "none", "what": "nothing"}', Detected(False)),
        ('{"is_ood": false, "confidence": 0.9, "certainty": 0.2}', Detected(False)),
        ('{"is_ood": false, "confidence": 0.9, "certainty": "90%"}', Detected(False, "", 0.9)),
        ("Yes, a deer. That was a lie.", None),
        ("Yes, unusual: no cars on the road", None),
        ("No, nothing here is normal.", None),
        ("No, that is no ordinary truck, it is on fire", None),
        ("No. A house burns, no cars around.", None),
        ("No, it is clear that a cow blocks the road", None),
        ("No, none of the lights work", None),
        ("No, the road is not clear.", None),
        ("No, nothing is unusual. The road is clear and traffic flows normally.", Detected(False)),
        ("> yes", None),
        ('{"is_ood": true, "reasoning": "This is not my answer."}', None),
        ('{"is_ood": true, "retracted": "yes"}', None),
    ],
)
def test_whether_what_and_how_surely(said, found):
    read = read_aspect(said)
    assert read.value == found


@pytest.mark.parametrize(
    ("said", "aspect"),
    [
        ('{"reasoning": "x", "aspect": "a deer"}', "a deer"),
        ("**OOD aspect:** An overturned vehicle ahead.", "An overturned vehicle ahead"),
        ("An overturned vehicle ahead.", "An overturned vehicle ahead"),
        ("The OOD aspect is an overturned vehicle.", "an overturned vehicle"),
        ("No traffic lights working", "No traffic lights working"),
        ('{"aspect": "none"}', ""),
        ('{"aspect": ""}', ""),
        ("There is nothing unusual.", ""),
        ("None.", ""),
        ("Aspect: a deer. Confidence: 80%", "a deer"),
        ("Yes. A deer", "A deer"),
    ],
)
def test_a_named_aspect(said, aspect):
    reading = read_named_aspect(said)
    assert (reading.value, reading.outcome) == (aspect, "answered")


@pytest.mark.parametrize(
    ("said", "outcome"),
    [
        ("I'm sorry, I can't help with that.", "refused"),
        ("", "unparsed"),
        ('{"reasoning": "x"}', "unparsed"),
        ('{"aspect": "..."}', "unparsed"),
        ('{"aspect": "."} a deer', "unparsed"),
        ('{"aspect": "a deer"} {"aspect": "a box"}', "unparsed"),
        ('{"aspect": "a deer", "aspect": "a box"}', "unparsed"),
        ("I don't know.", "unparsed"),
        ("A deer? Or a dog?", "unparsed"),
        ("Yes", "unparsed"),
        ("True.", "unparsed"),
        ("42", "unparsed"),
        ('{"aspect": "yes"}', "unparsed"),
        ("No, a deer.", "unparsed"),
        ("True, a deer.", "unparsed"),
        ("I can't see the image.", "refused"),
        ("I can't see anything in the image.", "refused"),
        ("word " * 200_000, "unparsed"),
    ],
)
def test_what_names_no_aspect_is_told_apart(said, outcome):
    assert read_named_aspect(said).outcome == outcome


ABSENT = (
    "No driver in the car", "No lights on the lorry", "None of the traffic lights work", "No road markings",
    "There is no driver in the car", "No wheels on an ordinary car", "Intersection without functioning lights", "Tail lights not working",
    "Absence of lane markings",
)  # fmt: skip
NOTHING = (
    "There is nothing unusual", "There is no OOD aspect", "Everything looks normal", "Nothing stands out", "I see nothing",
    "There are no unusual objects", "Nothing is out of the ordinary", "No anomalies", "Nothing seems strange", "No aspect",
    "None of the objects are unusual", "There isn't anything unusual", "It is not unusual", "No unusual aspect is visible",
    "No deer, no dog: nothing unusual", "There's nothing unusual", "There\u2019s nothing unusual", "I can't see anything unusual",
    "I couldn't detect any anomalies", "There doesn't appear to be anything unusual", "Nothing notable", "No issues",
    "No unusual objects or events", "It looks like a normal road", "Everything looks normal and clear", "All clear",
    "The image shows a normal road", "It's a typical street", "No obvious hazards",
    "No anomalies were detected", "The road is clear with no visible hazards", "None of note", "Nothing, just a normal road",
    "That's nothing unusual", "This is a normal driving scene with nothing unusual", "It's all normal", "Nothing in particular stands out",
    "No hazards, obstacles, or unusual objects", "Normal traffic with a few cars", "The scene is in-distribution", "No deviation from normal driving",
    "The scene is unremarkable", "An uneventful drive", "There is an absence of hazards",
)  # fmt: skip


NAMED = (
    "Northbound truck parked across both lanes", "Noise barrier fallen on the road", "November snow on the road", "A truck in both lanes",
    "A smooth object on the road", "Clear visible hazard on the road",
    "Pedestrian crossing where no crossing is expected", "It is not normal: a cow on the road",
)  # fmt: skip
OPEN = (
    "No lights on the oncoming truck, no hazard detected", "Nothing really catches my eye", "There's nothing for the driver to mind",
    "I can't see much", "Nothing unusual, a deer", "Nothing blocks the road", "No unusual lights on the car",
    "No problem: a deer is on the road", "Everything looks normal, with a deer",
    "No deer on the road", "This is not normal", "An ordinary car drives the wrong way", "No one is driving", "A lorry drives as usual",
    "Nothing holds the load", "Nobody at the wheel", "Weather", "There is", "I am not sure whether anything is unusual",
    "Frame 3: nothing unusual", "Left lane: nothing. Right lane: nothing", "Verdict: nothing unusual",
)  # fmt: skip


@pytest.mark.parametrize("named", NAMED)
@pytest.mark.parametrize("tail", ["", ", no hazard visible", ", unknown", ", no problem"])
def test_a_denial_behind_a_name_denies_nothing_of_it(named: str, tail: str) -> None:
    for said in (f"{named}{tail}", json.dumps({"aspect": f"{named}{tail}"})):
        assert read_named_aspect(said).value == f"{named}{tail}"
    assert not names_nothing(f"{named}{tail}")


@pytest.mark.parametrize("said", OPEN)
def test_what_neither_names_nor_denies_plainly_is_asked_again(said: str) -> None:
    for one in (said, json.dumps({"aspect": said})):
        assert read_named_aspect(one).outcome == "unparsed"
    for one in (said, json.dumps({"is_ood": True, "aspect": said})):
        assert read_aspect(one).outcome == "unparsed"


def test_a_long_aspect_names_a_thing() -> None:
    said = f"a deer {'on the left of the road ' * 60}"
    assert read_named_aspect(json.dumps({"aspect": said})).value == said.strip()


@given(
    st.sampled_from(ABSENT),
    st.sampled_from(["", ", which is unusual", ", very unusual", " - unusual"]),
    st.sampled_from(["", "."]),
)
def test_what_is_absent_is_an_aspect(absent: str, tail: str, end: str) -> None:
    assert read_named_aspect(f"{absent}{tail}{end}").value == f"{absent}{tail}"
    said = json.dumps({"aspect": f"{absent}{tail}"})
    assert read_named_aspect(said).value == f"{absent}{tail}"


@given(
    st.sampled_from(NOTHING),
    st.sampled_from(["", " here", " in this image", " in the scene", " in these frames"]),
    st.sampled_from(["", ".", "!"]),
)
def test_a_denial_is_no_aspect(denial: str, where: str, end: str) -> None:
    assert read_named_aspect(f"{denial}{where}{end}").value == ""
    assert read_named_aspect(json.dumps({"aspect": f"{denial}{where}{end}"})).value == ""
    said = json.dumps({"is_ood": True, "aspect": f"{denial}{where}{end}"})
    assert "which says true beside the aspect" in read_aspect(said).note
    assert read_aspect(f"{denial}{where}{end}").value in (Detected(False), None)


DENIALS = st.builds(
    "{}{}{}{}{}".format,
    st.sampled_from(
        [
            "No", "There are no", "There's no", "I see no", "The image shows no", "I don't see any", "I could not find any", "Without any",
            "The scene doesn't contain any", "There aren't any", "This scene does not have any", "There is no sign of any",
        ]
    ),
    st.sampled_from(["", " unusual", " significant", " major", " clear", " immediate", " noticeable", " out-of-distribution", " notable"]),
    st.sampled_from(
        [" anomalies", " abnormalities", " hazards", " obstacles", " OOD aspects", " problems or hazards", " issues", " objects", " vehicle behaviour"]
    ),
    st.sampled_from(["", " observed", " are visible", " were detected", " can be seen", " have been found", " seem to be present"]),
    st.sampled_from(["", " here", " in this image", " on the road", " in the lane ahead", " in the given frames"]),
)  # fmt: skip
THINGS = st.sampled_from(["a cow", "a cow stands on the road", "the lorry burns", "no driver"])


@given(DENIALS | st.sampled_from(NOTHING))
def test_a_composed_denial_never_names_an_aspect(denial: str) -> None:
    assert read_named_aspect(denial).value == ""
    assert read_aspect(f"No, {denial}").value == Detected(False)
    assert read_aspect(f"Yes, {denial}").value is None
    assert read_aspect(denial).value in (Detected(False), None)


@given(st.lists(DENIALS | st.sampled_from(NOTHING), min_size=1, max_size=2), THINGS, st.integers(0))
def test_a_thing_among_denials_is_neither_denied_nor_named(
    denials: list[str], thing: str, at: int
) -> None:
    denials.insert(at % len(denials) + 1, thing)
    said = ", ".join(denials)
    assert read_named_aspect(said).value is None
    assert read_aspect(f"No, {said}").value is None
    assert read_aspect(said).value is None
    assert "beside the aspect" in read_aspect(json.dumps({"is_ood": False, "aspect": said})).note


@given(THINGS)
def test_a_thing_does_not_go_with_no(thing: str) -> None:
    for said in ("", "this does not look normal: ", "it is far from normal, ", "on a clear road, "):
        assert read_aspect(f"No, {said}{thing}").outcome == "unparsed"


@given(
    st.sampled_from(["Unusual", "OOD", "Is this scene unusual", "Anomaly", "Is it out of the ordinary"]),
    st.sampled_from(["? ", ": "]),
    st.sampled_from(["", ".", "!", "\nConfidence: 80%"]),
)  # fmt: skip
def test_yes_and_no_are_read_alike(question: str, mark: str, end: str) -> None:
    for said, is_ood in (("Yes", True), ("No", False)):
        found = read_aspect(f"{question}{mark}{said}{end}").value
        assert found == Detected(is_ood, "", 0.8 if "80" in end else None)


@pytest.mark.parametrize(
    "aspect",
    [
        "no driver behind the wheel",
        "a car with no wheels",
        "a deer on a clear road",
        "a pedestrian in the usual lane",
        "the fog is thicker than usual",
        "the traffic lights show nothing",
        "there is no driver in the car",
    ],
)
def test_a_hazard_of_absence_goes_with_yes(aspect: str) -> None:
    assert read_aspect(f"Yes, {aspect}.").value == Detected(True, aspect)


@pytest.mark.parametrize(
    "rest",
    [
        "everything is normal", "nothing unusual", "there is nothing unusual here", "no anomalies", "the scene is clear", "all normal",
        "a typical street", "this is in-distribution", "I see none", "there are no hazards", "it is ordinary", "cars behave as usual", "a car, but ordinary",
    ],
)  # fmt: skip
def test_an_ordinary_scene_does_not_go_with_yes(rest: str) -> None:
    assert read_aspect(f"Yes, {rest}.").outcome == "unparsed"


@pytest.mark.parametrize(
    "part",
    [
        "unusual ",
        "no ",
        "no is ",
        "no deer or ",
        "ok ",
        "car ",
        "lly ",
        "is ",
        "....",
        "a, ",
        "confidence ",
        "my " * 12,
    ],
)
def test_long_answers_are_read_at_once(part: str) -> None:
    long = (part * 5_000)[:50_000]
    for said in (long, f"Yes, {long}", f"Aspect: {long}"):
        read_aspect(said)
        read_named_aspect(said)
        names_nothing(said)


@given(st.text(max_size=60))
def test_any_text_is_read_and_names_something_or_nothing(said):
    reading = read_named_aspect(said)
    assert (reading.value is None) == (reading.outcome != "answered")
    assert not reading.value or not names_nothing(reading.value)
    again = read_named_aspect(json.dumps({"aspect": said}))
    assert again.value is None or isinstance(again.value, str)


MARKS = st.sampled_from(["Verdict: ", "Answer: ", "My answer is: ", "Unusual? ", "Is it OOD? ", "Anomaly: ", "Final verdict: ", ""])  # fmt: skip


@given(MARKS, st.sampled_from([", ", ". ", ": ", " - ", " (", "\n"]), THINGS)
def test_what_follows_a_yes_or_no_is_read_alike_behind_every_mark(
    mark: str, joint: str, thing: str
) -> None:
    end = ")" * (joint == " (")
    assert read_aspect(f"{mark}Yes{joint}{thing}{end}").value == Detected(True, thing)
    for said in (f"No{joint}{thing}{end}", f"Yes{joint}nothing is unusual{end}"):
        assert read_aspect(f"{mark}{said}").outcome == "unparsed"
    assert read_aspect(f"{mark}No{joint}nothing is unusual{end}").value == Detected(False)


@given(
    st.sampled_from(
        [
            "Nothing is unusual", "There is no anomaly", "Nothing out of the ordinary", "Is there no anomaly", "I see nothing unusual", "No anomaly",
            "The statement that nothing is unusual", "Neither is unusual", "It is hardly unusual", "It isn't unusual", "The scene has no anomaly",
            "I cannot find, in any frame, anything unusual", "I do not think, given the frames, that the answer is",
        ]
    ),
    st.sampled_from([":", "?", " ="]),
    st.sampled_from(["yes", "true", "Yes, the road is clear.", "Yes, a deer"]),
)  # fmt: skip
def test_a_yes_to_a_denial_is_no_yes(denial: str, mark: str, said: str) -> None:
    assert read_aspect(f"{denial}{mark} {said}").outcome == "unparsed"


@pytest.mark.parametrize(
    ("before", "is_ood", "found"),
    [
        ("Everything is normal.", True, None),
        ("The road is clear.", True, None),
        ("Everything is normal on the left, a cow stands on the right,", True, Detected(True)),
        ("There is something unusual: a cow.", False, None),
        ("The image shows a street with parked cars and a pedestrian.", False, Detected(False)),
        ("I see nothing unusual, so", False, Detected(False)),
        ("A cow stands on the road,", True, Detected(True)),
    ],
)
def test_reasons_before_a_verdict_are_not_its_contrary(before, is_ood, found):
    said = "yes" if is_ood else "no"
    for mark in ("my verdict is: ", "Answer: "):
        assert read_aspect(f"{before} {mark}{said}.").value == found


@pytest.mark.parametrize(
    ("said", "found"),
    [
        ('{"is_ood": "Yes, a deer", "confidence": 0.9}', Detected(True, "a deer", 0.9)),
        ('{"answer": "Yes. A deer (80%)"}', Detected(True, "a deer", 0.8)),
        ('{"is_ood": "yes, clearly", "aspect": "a deer"}', Detected(True, "a deer")),
        ("OOD: yes, confidence 0.9, aspect: a deer", Detected(True, "a deer", 0.9)),
        ("Answer: No.\nThe road is clear.", Detected(False)),
        ('{"is_ood": "no, a deer"}', None),
        ("is_ood: yes, aspect: ", None),
    ],
)
def test_a_labelled_yes_or_no_is_read_like_an_opening_one(said, found):
    read = read_aspect(said).value
    assert read == found or (read.aspect.lower() == found.aspect and read.confidence == 0.8)


@pytest.mark.parametrize(
    "aspect",
    ["a St. Bernard dog on the road", "a U.S. mail truck", "a fire engine at 9 a.m. in the lane"],
)
def test_an_abbreviation_ends_no_sentence(aspect):
    assert read_aspect(f"Yes, {aspect}.").value == Detected(True, aspect)
    assert read_aspect(f"Yes, {aspect}. It burns.").outcome == "unparsed"


@pytest.mark.parametrize(
    "heading",
    ["Hazards", "Anomalies", "Unusual objects", "Unusual", "Problem", "Potential hazards", "The main OOD aspect", "Hazards on the road"],
)  # fmt: skip
@pytest.mark.parametrize("nothing", ["none", "nothing", "none visible", "nothing unusual"])
def test_a_heading_is_no_aspect(heading, nothing):
    assert read_named_aspect(f"{heading}: {nothing}").value == ""
    assert read_named_aspect(f"Weather: clear. {heading}: {nothing}").value == ""
    assert read_aspect(f"{heading}: {nothing}").value in (Detected(False), None)
    assert read_named_aspect(f"A dead cow: {nothing}").value != ""


@pytest.mark.parametrize(
    "thing", ["Animals", "Deer", "Other road users", "Pedestrians on the road"]
)
def test_a_denied_thing_is_no_aspect_and_goes_with_no(thing):
    assert read_named_aspect(f"{thing}: none").outcome == "unparsed"
    assert read_aspect(f"No. {thing}: none. Obstacles: none.").value == Detected(False)
    assert read_aspect(f"Yes. {thing}: none. Obstacles: none.").value is None
    assert read_named_aspect("Driver: none").value == "Driver: none"


@pytest.mark.parametrize("users", ["Cars and pedestrians", "All vehicles and cyclists", "Cars, cyclists and people"])  # fmt: skip
@pytest.mark.parametrize("act", ["behave normally", "move as expected", "look ordinary"])
def test_road_users_that_are_ordinary_together_are_no_aspect(users, act):
    assert read_named_aspect(f"{users} {act}.").outcome == "unparsed"


@given(
    st.integers(0, 130), st.sampled_from(["{} %", "{}%", "{} percent", "{}/100", "{} out of 100"])
)
def test_a_share_is_read_as_it_is_written(n, form):
    found = probability(form.format(n))
    assert found == (n / 100 if n <= 100 else None)


@given(st.integers(0, 1300))
@example(10)
@example(100)
@example(1000)
def test_a_bare_number_above_ten_is_a_percentage_and_one_up_to_one_a_share(tenths):
    number = tenths / 10
    wanted = number if number <= 1 else number / 100 if 10 < number <= 100 else None
    assert probability(number) == wanted
    assert probability(str(number)) == wanted
    assert probability(True) is None


@pytest.mark.parametrize(
    ("said", "wanted"),
    [
        ("50/50", 0.5), ("50:50", 0.5), (".5", 0.5), ("0,5", 0.5), ("about 50 percent", 0.5), ("0.7.", 0.7),
        ("0.7 (fairly sure)", 0.7), ("unsure", 0.5), ("Very-High", 0.97), ("-1", None), ("1,000", None),
        ("0.9 or 0.1", None), ("1e5", None), ("none whatsoever", None),
    ],
)  # fmt: skip
def test_a_doubt_is_no_certainty(said, wanted):
    assert probability(said) == wanted


SCALES = [
    "{}",
    "{}%",
    "{} %",
    "{} percent",
    "{}/5",
    "{}/10",
    "{} out of 4",
    "{} of 100",
    "high",
    "very low",
]


@given(st.sampled_from(SCALES), st.integers(0, 130).map(str) | st.sampled_from(["0.8", "0,3"]))
def test_prose_states_the_confidence_of_an_object(scale, number):
    said = scale.format(number)
    wanted = read_aspect(json.dumps({"is_ood": True, "aspect": "a deer", "confidence": said})).value
    assert wanted.confidence == probability(said)
    for form in (
        "Yes, a deer. Confidence: {}",
        "Yes, a deer, confidence {}.",
        "Answer: yes\nAspect: a deer\nConfidence: {}",
    ):
        assert read_aspect(form.format(said)).value == wanted


@given(st.floats(0, 1))
def test_a_number_of_an_object_is_its_confidence(number):
    assert probability(number) == number


@pytest.mark.parametrize(
    ("said", "aspect", "confidence"),
    [
        ("Yes, a deer. Confidence: 1-5%", "a deer", None),
        ("Yes, a deer. Confidence: 0.8 to 0.9", "a deer", None),
        ("Yes, a deer. Confidence: 4 (80%)", "a deer", 0.8),
        ("Yes, a deer. Confidence: ~85%.", "a deer", 0.85),
        ("Yes, a deer. I am 90 % sure.", "a deer", 0.9),
        ("Yes, I am not 100% sure.", "", None),
        ("Yes, a deer. I'm less than 50% sure.", "a deer", None),
        ("Yes, a deer (1).", "a deer (1)", None),
        ("Yes, a deer (1.0).", "a deer", 1.0),
        ("Yes, a deer (90%).", "a deer", 0.9),
    ],
)
def test_a_confidence_in_prose_is_not_guessed(said, aspect, confidence):
    assert read_aspect(said).value == Detected(True, aspect, confidence)


@pytest.mark.parametrize("said", ["No, normal. Not 100% sure.", "No. Confidence: 1-5%"])
def test_a_doubt_beside_no_is_no_certainty(said):
    assert read_aspect(said).value == Detected(False, "", None)


def test_words_rank_as_they_mean():
    words = ["unsure", "very low", "low", "medium", "high", "very high", "certain"]
    found = [probability(word) for word in words]
    assert found == sorted(set(found))


@given(st.integers(1, 40))
def test_the_name_of_an_aspect_has_at_most_twenty_words(n):
    said = " ".join(["deer"] * n)
    assert (read_named_aspect(said).value == said) is (n <= 20)


@given(st.integers(-3, 3))
def test_prose_of_more_than_300_characters_names_no_aspect(beyond):
    named = "deer" + "x" * (LONGEST_ASPECT - 4 + beyond)
    found = read_aspect(f"Yes,{named}").value
    assert (found is not None) is (beyond <= 0)


@pytest.mark.parametrize(
    "said",
    [
        '{"is_ood": 0.5}',
        '{"is_ood": 2}',
        '{"is_ood": [true, false]}',
        '{"is_ood": true, "anomaly": "no"}',
        "Answer: yes. Verdict: no.",
    ],
)
def test_what_is_neither_yes_nor_no_is_asked_again(said):
    assert read_aspect(said).outcome == "unparsed"


def test_an_ordinary_scene_has_no_aspect():
    assert read_aspect('{"is_ood": false, "aspect": "a deer"}').value == Detected(False)


SAID = {
    "cardboard box in the lane": True,
    "overturned lorry": True,
    "none": False,
    "Nothing unusual.": False,
}


@pytest.mark.parametrize("aspect", ["", None, " "])
def test_a_hazard_without_an_aspect_is_noted(aspect):
    found = read_aspect(json.dumps({"is_ood": True, "aspect": aspect}))
    assert (found.value.is_ood, found.note) == (True, "JSON, which says true without an aspect")


@given(st.booleans(), st.sampled_from(sorted(SAID)), st.sampled_from(["aspect", "what"]))
def test_an_aspect_that_does_not_go_with_the_yes_or_no_is_noted(
    is_ood: bool, said: str, name: str
) -> None:
    found = read_aspect(json.dumps({"is_ood": is_ood, name: said}))
    assert found.value is not None
    assert (found.value.is_ood, found.value.aspect) == (is_ood, said if is_ood else "")
    assert (found.note == "JSON") == (is_ood == SAID[said])
    assert (repr(said) in found.note) == (is_ood != SAID[said])


@given(st.sampled_from(["", "...", "ordinary traffic", "The road is clear."]))
def test_an_ordinary_aspect_goes_with_no(said: str) -> None:
    assert read_aspect(json.dumps({"is_ood": False, "aspect": said})).note == "JSON"


@pytest.mark.parametrize(
    "said", ["Yes", "Answer: yes", "Unusual: yes", '{"is_ood": true, "aspect": null}']
)
def test_a_yes_without_an_aspect_is_noted_in_every_form(said):
    assert "true without an aspect" in read_aspect(said).note


@pytest.mark.parametrize("said", ["null", "Aspect: null", '{"aspect": "null"}'])
def test_null_names_no_aspect(said):
    assert read_named_aspect(said).value == ""


@pytest.mark.parametrize(
    "said", ["Nope.", "Nah", "undefined", "Zero", "Absent.", "Empty", "Nope, nothing unusual."]
)
def test_a_plain_no_names_no_aspect(said):
    assert read_named_aspect(said).value == ""
    assert "beside the aspect" in read_aspect(json.dumps({"is_ood": True, "aspect": said})).note


def test_a_plain_no_before_other_words_may_begin_a_name():
    for said in ("Zero-visibility fog", "Absent road markings", "Empty truck on its side"):
        assert read_named_aspect(said).value == said


@pytest.mark.parametrize(
    "more",
    [
        "definitely",
        "indeed",
        "it is",
        "there is",
        "I think so",
        "there clearly is, indeed",
        "sure!",
    ],
)
def test_words_that_only_affirm_are_no_aspect(more):
    read = read_aspect(f"Yes, {more}.")
    assert read.value == Detected(True)
    assert "true without an aspect" in read.note
    for said in (f"Yes, {more}.", more, json.dumps({"aspect": more})):
        assert read_named_aspect(said).outcome == "unparsed"


@pytest.mark.parametrize("yes", ["Yes, ", "yes - ", "YES: "])
def test_a_yes_before_an_aspect_is_dropped_in_every_form(yes):
    for said in ("{}a deer", "Answer: {}a deer", "Unusual: {}a deer.", '{{"aspect": "{}a deer"}}'):
        assert read_named_aspect(said.format(yes)).value == "a deer"
    found = read_aspect(json.dumps({"is_ood": True, "aspect": f"{yes}a deer"})).value
    assert found == Detected(True, "a deer")
