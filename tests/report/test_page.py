from lxml import html

from oodscen import Study
from oodscen.report._load import Material, read
from oodscen.report._page import page_variables
from oodscen.report._render import render


def test_calls_are_summed_by_purpose(study: Study) -> None:
    rows = page_variables(study, read(study))["call_rows"]
    assert [(row.group[1] or row.group[0], row.calls, row.input_tokens) for row in rows] == [
        ("propose-tree", 1, 900),
        ("stage-scene", 2, 1803),
        ("all", 3, 2703),
    ]
    assert all(row.cost_usd == 0 for row in rows)


def test_an_unknown_price_of_an_answer_makes_the_sum_unknown(study: Study) -> None:
    study.store.append(
        "calls.jsonl", {"purpose": "x", "model": "m", "status": "failed", "cost_usd": None}
    )
    last = page_variables(study, read(study))["call_rows"][-1]
    assert (last.cost_usd, last.failed) == (0, 1)
    study.store.append(
        "calls.jsonl", {"purpose": "x", "model": "m", "status": "ok", "cost_usd": None}
    )
    assert page_variables(study, read(study))["call_rows"][-1].cost_usd is None


def test_nothing_at_all_still_makes_a_page(study: Study) -> None:
    words = text_of(study, Material())
    assert "This study has not got anywhere yet." in words
    assert "Which model wrote the trees, texts and scenes is not recorded." in words
    assert "paths –" in words


def test_counts_beside_the_papers(study: Study) -> None:
    words = text_of(study, read(study))
    assert "Nodes of the initial tree 7 40" in words
    assert "Paths whose scenario the paper simulated 3 9" in words
    assert "Texts in the set of 20 20 –" in words


def text_of(study: Study, found: Material) -> str:
    page = html.document_fromstring(render(page_variables(study, found)))
    return " ".join(" ".join(page.itertext()).split())
