"""The pictures of failed drives: each drive of each test has its own files, and all places name the same ones."""

import re
from collections import Counter
from xml.etree import ElementTree

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from oodscen.pytest_plugin._driving import picture_stem

pytest_plugins = ["pytester"]

XDIST = ("-p", "xdist.plugin", "-n", "1")
TESTS = """
import pytest
import stack


@pytest.mark.parametrize("name", ["keep_speed", "KEEP_SPEED"])
def test_both(drive, name):
    drives = [drive(stack.Blind, name=name), drive(stack.Late, name=name)]
    assert all(one.is_safe for one in drives)


class TestA:
    def test_both(self, drive):
        assert drive(stack.Blind).is_safe


class TestB(TestA):
    pass
"""
LATE = """Blind


class Late(Blind):
    def __init__(self):
        self.keep, self.brake = make_driver("keep_speed"), make_driver("stop")

    def act(self, observation):
        return (self.keep if observation.time > 1.0 else self.brake).act(observation)
"""
drives = st.tuples(
    st.sampled_from(["a-001", "A-001", "a-001~twin", "b" * 200]),
    st.text(max_size=200),
    st.text(max_size=200),
    st.integers(0, 3),
)


@example([("a", "t.py::test[a]", "d", 0), ("a", "t.py::Test::test[a]", "d", 0)])
@example([("a", "t.py::test", "d", 1), ("a", "t.py::test", "d", 11)])
@given(st.lists(drives, min_size=2, max_size=4, unique_by=lambda drive: (drive[1], drive[3])))
def test_no_two_drives_share_a_name_and_every_file_system_takes_it(made) -> None:
    stems = [picture_stem(*one) for one in made]
    assert len({stem.lower() for stem in stems}) == len(made)
    assert all(re.fullmatch(r"[A-Za-z0-9_~-]{1,140}", stem) for stem in stems)
    assert stems == [picture_stem(*one) for one in made]


@pytest.mark.parametrize("options", [(), XDIST])
def test_every_drive_of_every_test_has_pictures_of_its_own(session, pytester, options):
    for folder in ("d1", "d2"):
        (pytester.path / folder).mkdir()
        (pytester.path / folder / "__init__.py").touch()
        (pytester.path / folder / "test_more.py").write_text(TESTS)
    result = session(LATE, "-k", "test_both and box-001", "--junitxml=junit.xml", *options)
    assert result.parseoutcomes()["failed"] == 8
    files = {one.name for one in (pytester.path / "oodscen").iterdir()}
    shown = re.findall(r"^(?:frame|plan view) .*/oodscen/(\S+)$", result.stdout.str(), re.MULTILINE)
    tests = ElementTree.parse(pytester.path / "junit.xml").iter("testcase")
    told = {
        (test.get("classname"), test.get("name")): [
            one.get("value").rpartition("/")[2]
            for one in test.iter("property")
            if one.get("name") == "oodscen.picture"
        ]
        for test in tests
    }
    assert len(files) == 2 * 12
    assert Counter(shown) == Counter(name for names in told.values() for name in names)
    assert Counter(shown) == Counter(files)
    assert sorted(map(len, told.values())) == [2, 2, 2, 2, 4, 4, 4, 4]


@pytest.mark.parametrize("stack", ["Blind", "Startled"])
def test_pictures_that_cannot_be_written_are_told_and_change_no_outcome(session, pytester, stack):
    (pytester.path / "oodscen").write_text("in the way")
    options = (
        "-k",
        "test_safe or test_twin",
        "--junitxml=junit.xml",
        "--oodscen-require=safe>=0,needless<=1",
    )
    result = session(stack, *options)
    assert result.ret == 0
    assert result.parseoutcomes()["xfailed"]
    assert "failed" not in result.parseoutcomes()
    result = session(stack, *options[:-1])
    result.stdout.fnmatch_lines(["pictures   cannot write */oodscen*"])
