"""Which ordinary drives go with the scenes."""

from oodscen.data._episode import Episode
from oodscen.data._pairing import demand_id, is_ordinary, kind_of, scene_of, twin_id
from oodscen.judging._selection import choose_items

SCENES = tuple(f"x-{number:03d}" for number in range(40))


def episode(name: str, status: str = "ok") -> Episode:
    return Episode.parse({"id": name, "scene_id": name, "status": status})


def ordinary(found: list[Episode]) -> dict[str, list[str]]:
    kinds: dict[str, list[str]] = {}
    for one in found:
        if is_ordinary(one.scene_id):
            kinds.setdefault(scene_of(one.scene_id), []).append(kind_of(one.scene_id))
    return kinds


def test_one_ordinary_drive_goes_with_a_scene_half_of_them_demands():
    items = [f(name) for name in SCENES for f in (str, twin_id, demand_id)]
    episodes = [episode(name) for name in items]
    found = choose_items(episodes, count=1, seed=0)
    kinds = ordinary(found)
    assert {len(names) for names in kinds.values()} == {1}
    assert 10 < sum(names == ["twin"] for names in kinds.values()) < 30
    assert choose_items(episodes, count=1, seed=0) == found
    assert choose_items(episodes[:30], count=1, seed=0) == found[:20]
    assert choose_items(episodes, count=2, seed=0) == episodes


def test_where_one_did_not_run_the_other_goes_with_the_scene():
    for is_there in (False, True):
        twins = [episode(f(name)) for name in SCENES for f in (str, twin_id)]
        failed = [episode(demand_id(name), "failed") for name in SCENES] if is_there else []
        found = ordinary(choose_items([*twins, *failed], count=1, seed=0))
        assert all(names == ["twin"] for names in found.values())
