"""The table of contents of the site holds every page, and every link between pages has its target."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = sorted(DOCS.glob("*.md"))
FENCE = re.compile(r"^( *)(`{3,}).*?^\1\2$", re.DOTALL | re.MULTILINE)
TOCTREE = re.compile(r"^```\{toctree\}\n(.*?)^```$", re.DOTALL | re.MULTILINE)
LINK = re.compile(r"\]\((?!https?://)([^)#]*)(?:#([^)]+))?\)")


def prose(page: Path) -> str:
    """Return a page without its code, whose comments look like headings."""
    return FENCE.sub("", page.read_text(encoding="utf-8"))


def anchors(page: Path) -> set[str]:
    """Return the anchors of a page, as GitHub and the site make them from headings."""
    headings = re.findall(r"^#+ (.+)$", prose(page), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", line.lower()).replace(" ", "-") for line in headings}


def entries() -> list[str]:
    """Return the pages that the table of contents names."""
    lines = "\n".join(TOCTREE.findall((DOCS / "index.md").read_text(encoding="utf-8")))
    named = [line for line in lines.splitlines() if line and not line.startswith(":")]
    return [re.sub(r".*<(.*)>$", r"\1", line) for line in named]


def test_every_page_is_in_the_table_of_contents_once():
    written = [entry for entry in entries() if not entry.startswith("generated/")]
    assert sorted([*written, "index"]) == [page.stem for page in PAGES]


def test_the_site_writes_the_other_pages():
    configuration = (DOCS / "conf.py").read_text(encoding="utf-8")
    for entry in entries():
        if entry.startswith("generated/"):
            assert f'"{Path(entry).name}.md"' in configuration


def test_every_folder_of_examples_has_its_heading():
    configuration = (DOCS / "conf.py").read_text(encoding="utf-8")
    folders = [path for path in (ROOT / "examples").iterdir() if any(path.glob("*.*"))]
    assert folders
    for folder in folders:
        assert f"## {folder.name}\\n" in configuration or f'"{folder.name}"' in configuration


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.stem)
def test_links_have_their_targets(page):
    for target, anchor in LINK.findall(prose(page)):
        file = (page.parent / target).resolve() if target else page
        assert file.exists(), f"{page.name}: {target}"
        leaves = not file.is_relative_to(DOCS)
        assert not leaves or target.startswith(("../examples/", "../CHANGELOG.md")), target
        if anchor and file.suffix == ".md":
            assert anchor in anchors(file), f"{page.name}: {target}#{anchor}"


def test_the_changelog_links_pages_of_the_site():
    links = LINK.findall((ROOT / "CHANGELOG.md").read_text(encoding="utf-8"))
    assert links
    for target, anchor in links:
        file = (ROOT / target).resolve()
        assert file in PAGES, target
        assert not anchor or anchor in anchors(file), f"{target}#{anchor}"


def test_pictures_stay_small():
    assert (DOCS / "pictures" / "strip.jpg").stat().st_size < 100_000
