"""What a digest says in words is read back as it was."""

from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._catalogue import BehaviourKind, BehaviourParameter
from oodscen.prompts._digest import AssetLine, CatalogueDigest
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE

LIMITS = st.tuples(st.floats(-1e7, 1e7), st.floats(-1e7, 1e7)).map(sorted)


@given(st.dictionaries(st.sampled_from(("speed", "ttc_s", "lanes")), LIMITS))
def test_the_limits_of_parameters_are_read_back(limits):
    kind = BehaviourKind(
        id="drift",
        description="it drifts",
        categories=("vehicle",),
        parameters={
            name: BehaviourParameter(
                minimum=low, maximum=high, default=low, description="m/s (1..2)"
            )
            for name, (low, high) in limits.items()
        },
    )
    catalogue = FLAT_CATALOGUE.model_copy(update={"behaviours": (kind,)})
    (line,) = CatalogueDigest.of(catalogue).behaviours
    assert line.limits == {name: tuple(range_) for name, range_ in limits.items()}


def test_a_small_limit_is_a_limit():
    kind = FLAT_CATALOGUE.behaviours[0].model_copy(
        update={"parameters": {"speed": BehaviourParameter(minimum=1e-5, maximum=2.0, default=1.0)}}
    )
    catalogue = FLAT_CATALOGUE.model_copy(update={"behaviours": (kind,)})
    assert CatalogueDigest.of(catalogue).behaviours[0].limits == {"speed": (1e-5, 2.0)}


def test_states_of_many_assets_are_named_once():
    assets = tuple(
        AssetLine(id=f"a{number}", category="signal", description="x", states=states)
        for number, states in enumerate([("on", "off")] * 3 + [("up",)] * 2 + [()])
    )
    digest = CatalogueDigest(assets=assets, behaviours=(), maps=(), weather="")
    assert digest.state_sets == {"set 1": ("on", "off")}
    assert [digest.states_of(asset) for asset in assets] == [*["set 1"] * 3, *["up"] * 2, ""]


def test_a_plain_description_holds_every_word_of_the_id():
    def line(asset_id: str, description: str) -> AssetLine:
        return AssetLine(id=asset_id, category="object", description=description)

    assert line("fallen_tree", "a large fallen tree").is_plain
    assert line("cone", "two cones").is_plain
    assert not line("fallen_tree", "a large tree").is_plain
    assert not line("cones", "a cone").is_plain


def test_an_asset_is_called_by_its_id_first():
    assets = (
        AssetLine(id="lorry", category="vehicle", description="", names=("truck",)),
        AssetLine(id="truck", category="vehicle", description=""),
    )
    digest = CatalogueDigest(assets=assets, behaviours=(), maps=(), weather="")
    assert [asset.id for asset in digest.called("truck")] == ["truck", "lorry"]
    assert digest.called("van") == ()
