"""The picture of saturations is well-formed, whatever the logs hold."""

from xml.etree import ElementTree

from hypothesis import given
from hypothesis import strategies as st

from oodscen.stages._redteam.rounds import Round
from oodscen.stages._redteam.saturation import saturation
from tools.redteam.picture import main, picture

rounds = st.lists(
    st.sampled_from([("add", True), ("covered", False), (None, False)]), min_size=1, max_size=30
).map(
    lambda found: [
        Round(round=number, decision=decision, kind=f"kind-{number}" if is_new else None)
        for number, (decision, is_new) in enumerate(found, start=1)
    ]
)


@given(st.lists(rounds, min_size=1, max_size=4))
def test_it_is_well_formed_and_names_every_red_team(logs):
    drawn = picture({f"<{n}> & co": saturation(log) for n, log in enumerate(logs)})
    words = "".join(ElementTree.fromstring(drawn).itertext())
    assert all(f"<{n}> & co" in words for n in range(len(logs)))


def test_logs_are_read_from_files(tmp_path):
    log = tmp_path / "redteam.jsonl"
    log.write_text(Round(round=1, decision="add", kind="a").to_json() + "\n")
    main([str(tmp_path / "out.svg"), f"one={log}"])
    assert "1 kinds, 1 rounds" in (tmp_path / "out.svg").read_text()
