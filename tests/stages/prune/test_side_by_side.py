"""Two simulators side by side."""

import pytest

from oodscen.errors import UsageError
from oodscen.stages._prune.side_by_side import CatalogueComparison, compare, missing_kinds


@pytest.fixture(scope="module")
def comparison(diverse, catalogues, judged):
    return compare(diverse, catalogues, judged)


def test_every_leaf_has_a_line_with_a_side_for_every_catalogue(comparison, diverse):
    assert [line.id for line in comparison.lines] == [leaf.id for leaf in diverse.leaves]
    for line in comparison.lines:
        assert len(line.sides) == 2
        assert all(side.reason and side.match for side in line.sides)
        assert all(side.keep or side.missing for side in line.sides)


def test_the_figures_agree_with_the_lines(comparison):
    for number, tally in enumerate(comparison.tallies):
        sides = [line.sides[number] for line in comparison.lines]
        assert tally.kept == sum(side.keep for side in sides)
        assert tally.kept == tally.full + tally.substitute + tally.part
        assert tally.kept + tally.dropped == len(sides)
        alone = sum(
            line.sides[number].keep and not line.sides[1 - number].keep for line in comparison.lines
        )
        assert tally.alone == alone


def test_carla_has_no_snow_and_no_animals(comparison, catalogues):
    assert missing_kinds(catalogues["carla-0.9.16"]) == ("animal", "snow")
    assert missing_kinds(catalogues["pybullet"]) == ()
    assert "nothing at all of: animal, snow" in str(comparison)


def test_it_can_be_written_as_a_table_and_as_json(comparison):
    assert CatalogueComparison.parse(comparison.to_json()) == comparison
    rows = comparison.rows()
    assert len(rows) == len(comparison.lines)
    assert set(rows[0]) == {"branch", "pybullet", "carla-0.9.16"}
    assert str(comparison).count("\n") >= 3 * len(rows)


def test_names_must_agree(diverse, catalogues):
    with pytest.raises(UsageError, match="names"):
        compare(diverse, catalogues, {})
