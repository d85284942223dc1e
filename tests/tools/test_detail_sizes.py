"""The catalogue ships the sizes that its maker measures."""

import pytest
from oodscen_pybullet._catalogue import load_catalogue

from tools import detail_sizes

CATALOGUE = load_catalogue()


@pytest.mark.parametrize("name", ["child", "pickup"])
def test_shipped_sizes_are_measured(name: str) -> None:
    entry = CATALOGUE.asset(name).model_dump(mode="json")
    assert detail_sizes.measured(entry) == entry


def test_shipped_grips_are_where_the_hands_are() -> None:
    assert CATALOGUE.details is not None
    grips = {pose.id: list(pose.grip.at) for pose in CATALOGUE.details.poses if pose.grip}
    assert grips == {name: detail_sizes.grip_of(name) for name in grips}
