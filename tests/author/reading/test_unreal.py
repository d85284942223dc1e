"""Settings that a text only mentions: no frame of words that takes them back lets them through, for any of them."""

import pytest

from oodscen.author._reading.claim_extraction import read_claims

WEATHER = {
    "rain": "rain",
    "heavy rain": "heavy_rain",
    "drizzle": "light_rain",
    "snowfall": "snow",
    "heavy snow": "heavy_snow",
    "fog": "fog",
    "thick fog": "thick_fog",
    "mist": "mist",
}
ADJECTIVES = {"rainy": "rain", "foggy": "fog", "misty": "mist", "hazy": "mist", "cloudy": "cloudy"}
VERBS = {"rain": "rain", "snow": "snow", "drizzle": "light_rain"}
HOURS = {"night": "night", "dusk": "twilight", "dawn": "twilight", "noon": "day"}
KINDS = {"weather", "time"}


def settings(text):
    return {claim.value for claim in read_claims(text) if claim.kind in KINDS}


def each(frames, words):
    return [(frame.format(word), value) for frame in frames for word, value in words.items()]


PLAIN = (
    "In {} a cow stands in the ego's lane.",
    "A cow stands in the {} ahead.",
    "{} falls as the ego drives on.",
    "{} hides a cow in the ego's lane.",
    "{} has been falling since yesterday.",
    "{}, which has set in, hides the road.",
    "There is {}, and a sign shows 60.",
    "The car ahead has stopped in {}.",
    "In {} stopped cars block the lane.",
    "In {} warning lights flash ahead.",
    "A cow hardly moves in the {}.",
    "A police car called to a crash in {} stands ahead.",
    "{} turns the road slippery.",
    "{} of great intensity hides the road.",
    '"In {} a cow stands in the lane."',
    "{} is over the road ahead.",
    "{} has stopped all cars ahead.",
    "{} blows over the road.",
    "{} has gone from bad to worse.",
    "{} covers both lanes.",
    "{} has not stopped, and a cow stands in the lane.",
    "{} is not over.",
    "{} is coming down on the road.",
    "{} has replaced the sun.",
    "A sign stands in the {}.",
    "A radio lies on the road in the {}.",
    "A perhaps injured man lies in the {}.",
    "In the {} a box, perhaps a parcel, lies ahead.",
    "A driver talks to a guard in the {}.",
    "A van that used to be red stands in the {}.",
    "There is {} this morning.",
    "The cow was lost, and this morning {} hides it.",
    "In the {} a speaker says 60.",
    "The cow will soon be lost; {} hides it.",
    "Soon after dusk a cow stands in the {}.",
    "The ego can hardly see the cow in the {}.",
    "A news van stands in the {}.",
    "Warning lights of a lorry flash in the {}.",
    "{} drives away a cow.",
    "{} approaches the road from a field.",
    "{} is coming up from the river.",
)


@pytest.mark.parametrize(("text", "value"), each(PLAIN, WEATHER))
def test_weather_that_is_there_is_claimed(text, value):
    assert value in settings(text)


DENIALS = (
    "Instead of {} there is a clear view of a cow.",
    "Rather than {} there is wind.",
    "Unlike in {} the cow can be seen.",
    "There is hardly any {}.",
    "Without a trace of {} the cow is seen.",
    "There is zero {}.",
    "It is anything but {}.",
)
OVER = (
    "Last night's {} has dried.",
    "Yesterday's {} is forgotten.",
    "There was {} yesterday; now a cow stands here.",
    "There was {} this week; today a cow stands here.",
    "A few hours ago there was {}.",
    "{} is replaced by wind.",
    "{} gives way to wind.",
    "{} has given way to wind.",
    "{} turns into wind.",
    "The {} that hid the road has lifted.",
    "The {} has melted.",
    "The {} is gone from the road.",
    "The {} was over when the ego came.",
    "The {} let up an hour before.",
    "After hours of {} a cow stands here.",
    "Earlier {} has left the road soft.",
    "The {} was bad but now the view is good.",
    "The sun has replaced the {}.",
    "Wind replaces the {}.",
    "Sun follows the {}.",
    "A storm has driven away the {}.",
    "There was {} this morning.",
    "Early this morning there was {}.",
    "There had been {} earlier today.",
    "There used to be {} here.",
    "{} used to fall here.",
    "The sun has chased the {} away.",
    "There was {} until noon.",
    "Formerly there was {}.",
)
TO_COME = (
    "{} is coming.",
    "{} is coming soon.",
    "{} is on its way.",
    "{} is approaching from the north.",
    "There will be {}.",
    "There will soon be {}.",
    "There is {} tomorrow.",
    "Tomorrow there is {}.",
    "Soon there is {}.",
    "Later there is {}.",
    "{} approaches.",
    "There is {} in an hour.",
    "There is going to be {}.",
)
SUPPOSED = (
    "Perhaps there is {}.",
    "Maybe, there is {}.",
    "There is probably {}.",
    "Supposedly the {} falls.",
    "There is {}, presumably.",
    "Should there be {}, the road floods.",
    "Should {} fall, the road floods.",
    "Were there {}, the road would flood.",
    "Could there be {}?",
    "The driver thinks there is {}.",
    "The driver fears {}.",
    "The driver dreams of {}.",
    "{} is feared.",
    "Assuming there is {}, the road floods.",
    "Had there been {}, the road would be wet.",
    "There can be {} here.",
    "There is a possibility of {}.",
    "There is supposed to be {}.",
    "{} may hang over the road.",
)
SAID = (
    "A sign that says {} stands beside the road.",
    "A sign shows '{} AHEAD' beside the road.",
    'A board with "{}" on it stands ahead.',
    "The radio warns of {}.",
    "The weather app says there is {}.",
    "'{}', says a billboard.",
    "{} says a billboard.",
    "The radio speaks of {}.",
    "The radio is speaking about {}.",
    "The radio mentions {}.",
    "The radio talks about {}.",
    "A speaker tells of {} on the road.",
    "A speaker told the driver about {}.",
    "A sign tells of {}.",
    "A sign points to {} ahead.",
    "A sign refers to {}.",
    "There is talk of {} on the radio.",
    "A report of {} comes in.",
    "According to the radio there is {}.",
    "According to the radio, there is {}.",
    "There is {}, according to the radio.",
    "There is {} ahead, the radio says.",
    "{} is reported ahead.",
    "The news is that there is {}.",
    "The radio informs the driver of {}.",
    "The driver is told that there is {}.",
    "A sign indicates {}.",
    "A map of {} lies on the road.",
    "A man complains about the {}.",
)
FIGURES = (
    "A {} of gravel falls from a lorry.",
    "A {} of dust covers the road.",
    "Smoke as bad as {} drifts along.",
    "Dust like {} drifts along.",
    "Smoke resembling {} drifts along.",
    "A truck sprays as if there were {}.",
    "{} or shine, the van stops.",
    "Fake {} drifts along.",
)
NAMES = (
    "The {} detector fails.",
    "A {} sensor lies in the lane.",
    "A {} machine stands ahead.",
    "A person called {} walks across the road.",
)


@pytest.mark.parametrize(
    ("text", "value"), each((*DENIALS, *OVER, *TO_COME, *SUPPOSED, *SAID, *NAMES), WEATHER)
)
def test_weather_that_is_only_mentioned_is_not_claimed(text, value):
    assert not settings(text) - {"day"}


@pytest.mark.parametrize(
    ("text", "value"), each(FIGURES, {"rain": 0, "fog": 0, "mist": 0, "drizzle": 0, "haze": 0})
)
def test_weather_in_a_figure_of_speech_is_not_claimed(text, value):
    assert not settings(text)


@pytest.mark.parametrize(
    ("text", "value"),
    each(
        (
            "It hardly {}s.",
            "It seldom {}s.",
            "If it {}s the road floods.",
            "It no longer {}s.",
            "It stopped {}ing an hour ago.",
            "It was {}ing yesterday; today the view is good.",
            "It had been {}ing before a cow came.",
            "The wipers run as if it were {}ing.",
            "The weather app says it is {}ing.",
            "It used to {} here.",
            "Perhaps it {}s.",
            "Perhaps it is {}ing.",
            "Supposedly it {}s.",
            "Should it {}, the road floods.",
            "Were it to {}, the road would flood.",
            "It {}s tomorrow.",
            "It will be {}ing.",
            "According to the radio it is {}ing.",
            "It is {}ing, says the radio.",
            "It was {}ing this morning.",
        ),
        VERBS,
    ),
)
def test_what_does_not_fall_is_not_claimed(text, value):
    text = text.replace("drizzleing", "drizzling")
    assert not settings(text)


@pytest.mark.parametrize("verb", ["raining", "snowing", "drizzling"])
def test_what_falls_is_claimed(verb):
    for text in (
        "It is {}.",
        "It has been {} for hours.",
        "It has been {} all morning and the road is wet.",
        "It was {} when a cow came.",
        "It was {} this morning when a cow came.",
        "This morning it is {}.",
    ):
        assert settings(text.format(verb))


@pytest.mark.parametrize(
    ("text", "value"),
    each(
        (
            "The driver's mind is {}.",
            "The windscreen is all {}.",
            "A {} memory of a cow.",
            "It might be {}.",
            "It was {} this morning.",
            "It will be {}.",
            "Perhaps it is {}.",
            "Supposedly it is {}.",
            "A {} windscreen hides the cow.",
        ),
        ADJECTIVES,
    ),
)
def test_minds_and_panes_are_no_weather(text, value):
    assert not settings(text)


@pytest.mark.parametrize(("word", "value"), ADJECTIVES.items())
def test_an_adjective_of_the_weather_is_claimed(word, value):
    assert value in settings(f"It is {word} and a cow stands ahead.")
    assert value in settings(f"On a {word} road a cow stands ahead.")


@pytest.mark.parametrize(
    ("text", "value"),
    each(("Deer on the Road in {} Ahead", "A Truck in {}", "Stalled Van, {}, Wet Road"), WEATHER),
)
def test_title_case_makes_no_name_of_the_weather(text, value):
    assert value in settings(" ".join(word.capitalize() for word in text.split()))


ROADS = {"tunnel": "tunnel", "roundabout": "roundabout", "motorway": "highway", "bridge": "bridge"}


def roads(text):
    return {claim.value for claim in read_claims(text) if claim.kind == "road"}


@pytest.mark.parametrize(
    ("text", "value"),
    each(
        (
            "A sign announces a {}.",
            "A sign warns of a narrow {}.",
            "A sign says that a {} lies ahead.",
            "A sign shows a {}.",
            "A sign for a {} lies in the ego's lane.",
            "The radio speaks of the {}.",
            "The {} sign lies on the road.",
            "The old {} signs lie on the road.",
            "Perhaps there is a {} ahead.",
        ),
        ROADS,
    ),
)
def test_a_road_that_is_only_mentioned_is_not_claimed(text, value):
    assert not roads(text)


@pytest.mark.parametrize(
    ("text", "value"),
    each(
        (
            "A sign stands in the {}.",
            "A sign announces 60 on the {}.",
            "A sign that says 60 lies in the {}.",
            "The radio warns of ice in the {}.",
            "On a {} signs lie on the road.",
            "A cow, perhaps lost, stands in the {}.",
            "A driver tells a guard of a cow on the {}.",
        ),
        ROADS,
    ),
)
def test_a_road_with_signs_is_claimed(text, value):
    assert roads(text) == {value}


@pytest.mark.parametrize(
    "text",
    [
        "A sign says that there are two lanes in each direction.",
        "The radio speaks of dense traffic.",
        "According to the radio there is dense traffic.",
        "Perhaps there is dense traffic.",
        "A truck bears a photo of an empty road.",
    ],
)
def test_lanes_and_traffic_that_are_only_mentioned_are_not_claimed(text):
    assert not {"own_lanes", "road", "traffic"} & {claim.kind for claim in read_claims(text)}


@pytest.mark.parametrize("name", ["Misty", "Foggy", "Dusk", "Dawn", "Sunny", "Fog"])
def test_a_proper_name_is_neither_weather_nor_an_hour(name):
    for text in ("A person named {} walks.", "A {} taxi stops.", "A child and {} wait."):
        assert not settings(text.format(name))


@pytest.mark.parametrize("name", ["Misty", "Foggy", "Dusk", "Dawn", "Sunny", "Stormy"])
@pytest.mark.parametrize(
    "text",
    [
        "{} walks across the road.",
        "{}, a dog, runs across the road.",
        "{}, the neighbour's cat, sits in the ego's lane.",
        "{}, who carries a sofa, crosses the road.",
        "{} and her dog cross the road.",
        "{} is quickly crossing the road.",
        "A car stops. {} steps onto the road.",
    ],
)
def test_somebody_who_acts_at_the_start_of_a_sentence_is_neither_weather_nor_an_hour(text, name):
    assert not settings(text.format(name))


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("Misty weather hangs over the road.", "mist"),
        ("Misty, a dog runs across the road.", "mist"),
        ("Misty, a dog, a long road.", "mist"),
        ("Foggy roads lie ahead.", "fog"),
        ("Dawn breaks.", "twilight"),
        ("Dusk falls over the road.", "twilight"),
        ("Dusk is falling.", "twilight"),
        ("Dawn has come, and a dog crosses the road.", "twilight"),
    ],
)
def test_weather_and_hours_at_the_start_of_a_sentence_are_claimed(text, value):
    assert settings(text) == {value}


@pytest.mark.parametrize(
    ("text", "value"),
    each(
        (
            "Unlike at {}, the road is empty.",
            "It is as busy as at {} here.",
            "A sign says {}.",
            "It is not {}.",
            "The {} has passed.",
            "It looks as if it were {}.",
            "Perhaps it is {}.",
            "{} is coming.",
            "The radio speaks of {}.",
            "According to the radio it is {}.",
        ),
        HOURS,
    ),
)
def test_an_hour_that_is_only_mentioned_is_not_claimed(text, value):
    assert not settings(text)


@pytest.mark.parametrize(("hour", "value"), HOURS.items())
def test_an_hour_that_has_come_is_claimed(hour, value):
    assert settings(f"At {hour} a cow stands ahead.") == {value}
    assert settings(f"A cow stands ahead at {hour}.") == {value}


@pytest.mark.parametrize(
    "text",
    [
        "At night crew members cross the road.",
        "At night lorry drivers wait on the road.",
        "In the night taxi drivers wait on the road.",
        "By night train services block the level crossing.",
    ],
)
def test_those_who_act_at_an_hour_do_not_take_its_name(text):
    assert settings(text) == {"night"}


@pytest.mark.parametrize("hour", ["morning", "afternoon", "evening", "day", "night"])
def test_a_greeting_is_no_weather(hour):
    assert "clear" not in settings(f"Good {hour} to all.")
    assert "clear" in settings(f"On a clear {hour} a cow stands ahead.")


@pytest.mark.parametrize("first", ["lorry", "traffic", "smoke"])
def test_an_adjective_of_something_else_makes_no_fog_thick(first):
    assert settings(f"Dense {first} in fog.") == {"fog"}


def test_clouds_are_in_the_sky():
    assert settings("Thick clouds hang over the road.") == {"cloudy"}
    assert not settings("Thick clouds of smoke hang over the road.")


def things(text):
    return {claim.subject for claim in read_claims(text) if claim.kind == "thing"}


def test_animals_do_not_fall_from_the_sky():
    assert not things("It is raining cats and dogs.")
    assert settings("It is raining cats and dogs.") == {"rain"}
    assert things("In the rain cats and dogs cross the road.") == {"cat", "dog"}


@pytest.mark.parametrize(
    "saying", ["The radio speaks of", "The radio mentions", "A sign warns of", "A man tells of"]
)
def test_a_thing_that_is_only_mentioned_is_not_there(saying):
    assert "cow" not in things(f"{saying} a cow.")


@pytest.mark.parametrize("bearer", ["robot", "delivery robot", "juggler", "tall statue"])
def test_what_an_unnamed_bearer_carries_is_no_thing_of_its_own(bearer):
    assert "ball" not in things(f"A {bearer} with a ball stands in the ego's lane.")


@pytest.mark.parametrize("place", ["two-lane road", "quiet street", "wide junction", "scene"])
def test_what_lies_at_a_place_is_a_thing(place):
    assert things(f"A {place} with a ball in the ego's lane.") == {"ball"}


def test_a_long_list_that_is_denied_is_read_quickly():
    assert "rain" not in settings("no rain, fog, mist, " * 100)
