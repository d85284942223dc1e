"""The paper's facts: its named scenarios are found in labels, and ordinary ones are not."""

import pytest

from oodscen._paper import ATTESTED, attestation

LABELS = {
    "thick fog at night with a vehicle ahead": [
        "Thick fog at night with a vehicle ahead",
        "Dense fog, night",
    ],
    "large cardboard box, static debris": ["Large cardboard box on the road", "Static debris"],
    "overturned vehicle ahead": ["Overturned vehicle ahead", "Car that has rolled over"],
    "random object such as a plant pot": ["Random object (plant pot)", "Flower pot in the lane"],
    "sudden police checkpoint": ["Sudden police checkpoint", "Police road check-point"],
    "temporary change of road layout": [
        "Temporary change of road layout",
        "Changed lane arrangement",
    ],
    "large group of people": ["Parade on the road", "Large group of people on the road"],
    "vehicle driving the wrong way": ["Vehicle driving the wrong way", "Wrong-way driver"],
    "neighbour suddenly changing lane": [
        "Neighbour suddenly changing into the ego's lane",
        "Abrupt lane change of a car",
    ],
}


def test_the_paper_names_nine():
    assert len(ATTESTED) == 9
    assert {item.name for item in ATTESTED} == set(LABELS)


@pytest.mark.parametrize("label", [label for labels in LABELS.values() for label in labels])
def test_labels_that_name_them_are_attested(label):
    assert attestation(label) == "paper"


@pytest.mark.parametrize(
    "label", ["Deer on the road", "Fallen tree across the road", "Heavy snowfall", "Fog", "Police"]
)
def test_other_labels_are_not(label):
    assert attestation(label) is None
