"""Answers of every type as Hypothesis draws them."""

from hypothesis import strategies as st

from oodscen.data._claim import NUMBERS, OF_THINGS, VALUES, Claim
from oodscen.data._designs.motion import Motion
from oodscen.data._designs.prop import Prop
from oodscen.prompts._judging.name_aspect import OodAspect
from oodscen.prompts._tree.imagine_scenario import ImaginedScenario
from oodscen.prompts._tree.judge_branch import (
    BranchJudgement,
    BranchJudgements,
    NumberedJudgement,
    Substitute,
)
from tests.made import designs
from tests.motions import sound_motions


@st.composite
def claims(draw):
    """Draw claims that agree in themselves."""
    kind = draw(st.sampled_from([*VALUES, *NUMBERS]))
    number = st.integers(1, 1000).map(str)
    subject = st.text(min_size=1, max_size=20).filter(str.strip)
    return Claim(
        kind=kind,
        value=draw(number if kind in NUMBERS else st.sampled_from(list(VALUES[kind]))),
        subject=draw(subject) if kind in OF_THINGS else "",
        quote=draw(st.text(max_size=20)),
    )


st.register_type_strategy(Claim, claims())
st.register_type_strategy(Prop, designs().map(Prop.parse))
st.register_type_strategy(Motion, sound_motions())
st.register_type_strategy(
    OodAspect,
    st.builds(OodAspect, confidence=st.none() | st.floats(0.0, 1.0)),
)
said = st.text(min_size=1, max_size=20).filter(str.strip)
st.register_type_strategy(Substitute, st.builds(Substitute, asset=said, stands_for=said))
lists = dict.fromkeys(
    ("assets", "states", "behaviours", "weather", "traits"), st.lists(said, max_size=3)
)
st.register_type_strategy(BranchJudgement, st.builds(BranchJudgement, **lists))
# Drawn freely, several judgements are tens of thousands of characters that hide no more than a few do.
several = st.lists(st.builds(NumberedJudgement, **lists), max_size=3)
st.register_type_strategy(BranchJudgements, st.builds(BranchJudgements, judgements=several))
st.register_type_strategy(
    ImaginedScenario,
    st.builds(ImaginedScenario, once_in_km=st.none() | st.floats(1.0, 1e18)),
)
