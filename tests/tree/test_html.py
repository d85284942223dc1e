"""Outlines for notebooks and pages: every label once, as text, at any depth."""

import re
from html.parser import HTMLParser

from hypothesis import given

from oodscen.tree._edit_log import MAX_DEPTH
from oodscen.tree._html import MAX_SHOWN, Remark, notebook_html, tree_html
from oodscen.tree._scenario_tree import ScenarioTree, TreeEdit
from tests.tree.woods import ADDRESSED, HOSTILE, broad, chain, few, trees

TAGS = {"a", "b", "bdi", "details", "div", "li", "p", "small", "span", "style", "summary", "ul"}


class Reader(HTMLParser):
    """Collects tags, attributes and labels, and sees that all is closed in order."""

    def __init__(self, text):
        super().__init__()
        self.open, self.tags, self.attributes, self.labels, self.deepest = [], set(), set(), [], 0
        self.feed(text)
        self.close()
        assert not self.open

    def handle_starttag(self, tag, attributes):
        self.tags.add(tag)
        self.attributes |= {name for name, _ in attributes}
        self.open.append((tag, dict(attributes)))
        self.deepest = max(self.deepest, len(self.open))
        if (tag, dict(attributes).get("class")) == ("bdi", "name"):
            self.labels.append("")

    def handle_endtag(self, tag):
        assert self.open.pop()[0] == tag

    def handle_data(self, data):
        if self.open and self.open[-1][1].get("class") == "name":
            self.labels[-1] += data


@few
@given(trees)
def test_every_label_is_there_once_and_is_text(tree):
    for text in (tree_html(tree), tree._repr_html_()):
        read = Reader(text)
        assert read.labels == [node.label for node, _ in tree.walk()]
        assert read.tags <= TAGS
        assert read.attributes <= {"class", "open", "title"}


def test_remarks_are_text_too():
    tree = ScenarioTree.initial().apply(
        TreeEdit(op="add", node="a", parent="environmental", label=HOSTILE[0])
    )
    for hostile in (*HOSTILE, *ADDRESSED):
        remark = Remark(
            fate="dropped",
            origin=hostile,
            lines=((hostile, hostile),),
            link=f'#"><script>{hostile}',
            title=hostile,
        )
        text = tree_html(tree, {node.id: remark for node in tree.nodes})
        read = Reader(text)
        assert "script" not in read.tags
        assert read.attributes <= {"class", "open", "title", "href"}


def test_the_deepest_tree_is_shown_whole():
    tree = chain(MAX_DEPTH + 1)
    read = Reader(tree_html(tree))
    assert read.labels == [node.label for node in tree.nodes]
    assert read.deepest < 4 * MAX_DEPTH


def test_a_notebook_shows_whole_levels_up_to_a_limit_and_says_so():
    tree = broad(10_000)
    text = notebook_html(tree)
    shown = Reader(text).labels
    assert 0 < len(shown) <= MAX_SHOWN
    assert f"{len(tree) - len(shown):,} nodes below depth" in text


@few
@given(trees)
def test_one_is_told_in_the_singular(tree):
    told = [tree_html(tree), notebook_html(tree), notebook_html(tree, max(len(tree) - 1, 0))]
    for count, noun in re.findall(r"([\d,]+) (nodes?|paths?)\b", " ".join(told)):
        assert noun.endswith("s") == (count != "1")


def test_a_page_shows_every_node():
    tree = broad(3_504)
    page = tree.to_page()
    body = page.partition("<body>")[2].partition("</body>")[0]
    assert Reader(body).labels == [node.label for node, _ in tree.walk()]
    assert "not shown" not in page


def test_an_empty_tree_is_an_empty_list():
    assert Reader(notebook_html(ScenarioTree())).labels == []
    assert "An empty tree" in ScenarioTree().to_page()


def test_who_decided_turns_no_text_of_the_page_around():
    edits = [
        edit.model_copy(update={"model": "gnp.\u202eexe", "reason": "\u2066so"})
        for edit in chain(3).edits
    ]
    page = ScenarioTree(edits).to_page()
    assert "\\u202eexe" in page
    assert not {"\u202e", "\u2066"} & set(page)
