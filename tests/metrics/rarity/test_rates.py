"""Rates that are read, named or given."""

import numpy as np
import pytest

from oodscen.errors import DataError, UsageError
from oodscen.metrics._rarity.rates import PublishedRate, load_rates, published_rates, resolve_rates


def test_two_rates_of_one_wording_and_kind_share_a_figure():
    def worded(text, kind, *km):
        return PublishedRate(event="e", kind=kind, km=km, source="fleet", texts=("A fox.", text))

    first = worded("A deer jumps out.", "met", 10, 20, 40)
    for second in (
        worded("a deer jumps out", "met", 40, 50, 60),
        worded("A deer jumps out.", "own", 50, 60, 70),
    ):
        assert resolve_rates([first, second]) == (first, second)
    with pytest.raises(
        DataError, match=r"rate\[1\].km: excludes .* that have the text 'a deer jumps out'"
    ):
        resolve_rates([first, worded("a deer jumps out", "met", 41, 50, 60)])


def test_published_rates_have_sources_and_five_wordings():
    rates = published_rates()
    assert len({one.number for one in rates}) == len(rates) == 53
    assert all(len(set(one.texts)) == 5 for one in rates)
    assert {one.kind for one in rates} == {"own", "occurring", "met"}


@pytest.mark.parametrize(
    "content",
    ["", "rate = 3", "[[rate]]\nevent = 'x'", "[[rate", "[[rate]]\nevent='x'\nkm=[3,2,1]\nsource='s'\ntexts=['t']",
     "[[rate]]\nevent='x'\nkm=[1e-300,1,2]\nsource='s'\ntexts=['t']",
     "[[rate]]\nevent='x'\nkm=[1,2,'3 miles']\nsource='s'\ntexts=['t']",
     2 * "[[rate]]\nnumber=4\nevent='x'\nkm=[1,2,3]\nsource='s'\ntexts=['t']\n",
     "[[rate]]\nevent='x'\nkm=[true,true,true]\nsource='s'\ntexts=['t']",
     "[[rate]]\nevent='x'\nkm=['1','2','3']\nsource='s'\ntexts=['t']",
     "[[rate]]\nnumber=true\nevent='x'\nkm=[1,2,3]\nsource='s'\ntexts=['t']",
     "[[rate]]\nevent='x'\nkm=[1,2,inf]\nsource='s'\ntexts=['t']",
     "[[rate]]\nevent='x'\nkm=[1,2,3]\nsource='s'\ntexts=[2026-01-01]",
     "[[rate]]\nevent='x'\nkm=[1,2,3]\nsource='s'\ntexts=['t']\nfoo=1",
     "[[rate]]\nevent='x'\nkm=[1,2,3]\nsource=' '\ntexts=['t']",
     "[[rate]]\nevent='x'\nkm=[1,2,3]\nsource='s'\ntexts=['t', '']",
     "foo=1\n[[rate]]\nevent='x'\nkm=[1,2,3]\nsource='s'\ntexts=['t']",
     "[[rate]]\nevent='x'\nkm=[1,2,3]\nsource='s'\ntexts=['t']\n[rates]\nfoo=1",
     "".join(f"[[rate]]\nevent='x'\nkm=[{k},{k},{k}]\nsource='s'\ntexts=['t']\n" for k in (1, 10))],
)  # fmt: skip
def test_malformed_files_are_refused(content, tmp_path):
    file = tmp_path / "rates.toml"
    file.write_text(content)
    with pytest.raises(DataError, match=r"rates\.toml"):
        load_rates(file)


def test_a_huge_number_is_told_as_one_and_not_as_bad_json(tmp_path):
    file = tmp_path / "rates.toml"
    file.write_text(f"[[rate]]\nevent='x'\nkm=[1,1{'0' * 400},3]\nsource='s'\ntexts=['t']")
    with pytest.raises(DataError, match=r" 10+ \.\.\. is not a readable number") as caught:
        load_rates(file)
    assert "JSON" not in str(caught.value)


def test_rates_from_a_file(tmp_path):
    file = tmp_path / "rates.toml"
    file.write_text(
        "[[rate]]\nevent='deer'\nkm=[1e5,2e5,4e5]\nsource='fleet'\ntexts=['A deer jumps out.']"
    )
    (found,) = load_rates(file)
    assert found.kind == "met"
    assert found.log10_km == pytest.approx(5.30103)


def test_rates_are_named_given_or_in_a_file(tmp_path):
    assert resolve_rates(None) is None
    assert resolve_rates("published") == published_rates()
    for rates in (list(published_rates()), np.array(published_rates(), dtype=object)):
        assert resolve_rates(rates) == published_rates()
    with pytest.raises(DataError, match="there is none"):
        resolve_rates([])
    with pytest.raises(DataError):
        resolve_rates(tmp_path / "missing.toml")
    for other in (["x"], 5, {"rate": 1.0}):
        with pytest.raises(UsageError, match="anchors"):
            resolve_rates(other)
