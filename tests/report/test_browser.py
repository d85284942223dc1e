"""The page as a browser shows it; needs Playwright and a Chromium of the system."""

import copy
import json
import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from oodscen import Study
from oodscen.report import _page as pages
from oodscen.report._load import read
from oodscen.report._quiz import write_quiz
from oodscen.report._render import render
from tests.pipeline.quick import as_made
from tests.report.conftest import build_study
from tests.report.test_render import HOSTILE

playwright = pytest.importorskip(
    "playwright.sync_api", reason="Playwright is not installed (pip install 'oodscen[browser]')"
)
NAMES = ("chromium", "chromium-browser", "google-chrome")
CHROMIUM = os.environ.get("OODSCEN_CHROMIUM") or next(filter(None, map(shutil.which, NAMES)), None)
pytestmark = pytest.mark.skipif(
    CHROMIUM is None, reason="there is no chromium on the path (or in OODSCEN_CHROMIUM)"
)

BATCH = 40
MANY = 1_000


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with playwright.sync_playwright() as driver:
        chromium = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield chromium
        chromium.close()


@pytest.fixture(scope="module")
def judged(tmp_path_factory: pytest.TempPathFactory) -> Study:
    study = build_study(tmp_path_factory.mktemp("judged") / "study", per_path=3, with_twins=True)
    study.write_report()
    return study


@pytest.fixture(scope="module")
def crowded(tmp_path_factory: pytest.TempPathFactory, judged: Study) -> Path:
    """Write the page of a thousand scenes with twins, all made of a few."""
    context = pages.page_variables(judged, read(judged))
    few = context["payload"]["scenes"]
    rows = [copy.deepcopy(few[index % len(few)]) for index in range(MANY)]
    for index, row in enumerate(rows):
        row["id"] = f"scene-{index:04d}"
    rows.sort(key=lambda row: row["leaf"])
    context["payload"] = {**context["payload"], "scenes": rows}
    context["cards"] = MANY
    file = tmp_path_factory.mktemp("crowded") / "report.html"
    file.write_text(render(context), encoding="utf-8")
    return file


class Tab:
    """One opened page with everything that it complained about."""

    def __init__(self, browser: Any, **options: Any) -> None:
        self.context = browser.new_context(
            **{"viewport": {"width": 1200, "height": 900}, **options}
        )
        self.page = self.context.new_page()
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("dialog", lambda dialog: self.complaints.append(f"dialog {dialog.message}"))
        self.page.on("request", lambda request: self.requests.append(request.url))

    def open(self, file: Path, link: str = "") -> Any:
        self.page.goto(f"{file.as_uri()}{link}")
        return self.page

    def count(self, selector: str) -> int:
        return int(self.page.locator(selector).count())

    def has(self, cards: int) -> None:
        playwright.expect(self.page.locator("article.card")).to_have_count(cards)

    def shown(self) -> str:
        return str(self.page.locator("#shown").inner_text())


@pytest.fixture
def tab(browser: Any) -> Iterator[Callable[..., Tab]]:
    opened: list[Tab] = []

    def make(**options: Any) -> Tab:
        opened.append(Tab(browser, **options))
        return opened[-1]

    yield make
    for one in opened:
        one.context.close()


def report(study: Study) -> Path:
    return study.folder / "report.html"


def first(study: Study) -> str:
    return study.scenes[0].id


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_nothing_is_complained_about_and_nothing_is_fetched(
    tab: Callable[..., Tab], judged: Study, scheme: str
) -> None:
    one = tab(color_scheme=scheme)
    page = one.open(report(judged))
    colours = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert (colours == "rgb(19, 22, 25)") == (scheme == "dark")
    page.goto(f"{report(judged).as_uri()}#scene-{first(judged)}")
    page.locator(".whole").wait_for()
    assert one.count(".whole .frames img") == 6
    assert one.count(".whole svg.strip") == 12
    assert one.complaints == []
    assert all(url.startswith("file:") for url in one.requests)


def test_filters_and_the_links_they_make(tab: Callable[..., Tab], judged: Study) -> None:
    one = tab()
    page = one.open(report(judged))
    assert one.shown() == "9 scenes"
    for control, value, cards in (
        ("outcome", "mixed", 7), ("outcome", "failed", 2), ("outcome", "none", 0), ("safe", "3", 7),
        ("class", "Interactional", 3), ("weather", "fog", 3), ("behind", "none", 7), ("behind", "some", 0), ("result", "contradiction", 0),
    ):  # fmt: skip
        page.select_option(f"[name={control}]", value)
        one.has(cards)
        assert page.evaluate("location.hash") == f"#scenes?{control}={value}"
        assert page.locator("#none").is_visible() == (cards == 0)
        page.click("#f-reset")
        one.has(9)
    page.fill("[name=q]", "CARDBOARD case 2")
    one.has(1)
    page.fill("[name=q]", "something ahead")
    one.has(7)
    page.select_option("[name=model]", "0")
    page.select_option("[name=result]", "safe")
    one.has(3)
    link, found = page.evaluate("location.hash"), one.count("article.card")
    other = tab()
    other.open(report(judged), link)
    assert other.count("article.card") == found > 0
    assert other.page.locator("[name=q]").input_value() == "something ahead"
    other.open(report(judged), "#path-wrong-way")
    other.has(3)
    assert one.complaints == other.complaints == []


def test_the_keyboard_is_enough(tab: Callable[..., Tab], judged: Study) -> None:
    one = tab()
    page = one.open(report(judged))
    page.keyboard.press("/")
    page.keyboard.type("wrong-way")
    one.has(3)
    for _ in range(30):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.className") == "id":
            break
    name = page.evaluate("document.activeElement.textContent")
    page.keyboard.press("Enter")
    page.locator(f"article.whole[aria-label='Scene {name}']").wait_for()
    assert page.evaluate("document.activeElement.tagName") == "H2"
    page.keyboard.press("ArrowRight")
    page.locator("article.whole[aria-label='Scene wrong-way-002']").wait_for()
    page.keyboard.press("ArrowLeft")
    page.locator(f"article.whole[aria-label='Scene {name}']").wait_for()
    page.keyboard.press("Escape")
    page.locator("article.card").first.wait_for()
    assert one.count("article.whole") == 0
    assert page.evaluate("document.activeElement.textContent") == name
    assert one.count("article.card") == 3
    page.keyboard.press("/")
    page.keyboard.press("Escape")
    one.has(9)
    assert one.complaints == []


def test_a_link_to_a_scene_opens_it_and_an_unknown_one_is_told(
    tab: Callable[..., Tab], judged: Study
) -> None:
    one = tab()
    page = one.open(report(judged), f"#scene-{first(judged)}~twin")
    assert first(judged) in page.title()
    assert page.locator("#models").is_hidden()
    assert one.count(".answers") == 1
    page.click("#back")
    page.locator("#models").wait_for()
    inherited = ("constructor", "toString", "__proto__")
    missed = {
        f"#{kind}-{name}": name for kind in ("scene", "path") for name in ("unknown", *inherited)
    }
    odd = ("#%E0%A4%A", "#scenes?outcome=x&nothing=1", "#scenes?result=constructor", "#__proto__")
    for link in (*missed, *odd):
        page.goto(f"{report(judged).as_uri()}{link}")
        assert page.locator("#models").is_visible()
        assert page.locator("#unknown").is_visible() == (link in missed)
        assert one.shown() == "9 scenes"
        if link in missed:
            assert f"“{missed[link]}” in this study" in page.locator("#unknown").inner_text()
    assert one.complaints == []


@pytest.mark.parametrize("width", [320, 390])
def test_a_narrow_screen_never_scrolls_sideways(
    tab: Callable[..., Tab], judged: Study, width: int
) -> None:
    one = tab(viewport={"width": width, "height": 800})
    page = one.open(report(judged))
    page.evaluate("document.querySelectorAll('details').forEach(box => { box.open = true })")
    wide = "document.documentElement.scrollWidth"
    assert page.evaluate(wide) <= width
    page.goto(f"{report(judged).as_uri()}#scene-{first(judged)}")
    page.locator(".whole").wait_for()
    page.evaluate("document.querySelectorAll('details').forEach(box => { box.open = true })")
    assert page.evaluate(wide) <= width


def test_a_thousand_scenes_with_twins_cost_a_screenful(
    tab: Callable[..., Tab], crowded: Path
) -> None:
    one = tab()
    page = one.open(crowded)
    assert one.shown() == f"{MANY} scenes"
    assert one.count("article.card") == BATCH
    nodes = page.evaluate("document.querySelectorAll('*').length")
    assert nodes < 8_000
    page.evaluate(
        "() => { window.made = 0; new MutationObserver(rows => { for (const row of rows) window.made += [...row.addedNodes].filter(node => node.matches?.('article')).length })"
        ".observe(document.getElementById('list'), {childList: true, subtree: true}) }"
    )
    page.fill("[name=q]", "ordinary-nothing")
    one.has(0)
    page.fill("[name=q]", "case")
    one.has(BATCH)
    assert page.evaluate("window.made") == BATCH
    page.locator("#more").scroll_into_view_if_needed()
    playwright.expect(page.locator("article.card").nth(BATCH)).to_be_attached()
    assert one.count("article.card") <= 4 * BATCH
    page.goto(f"{crowded.as_uri()}#scene-scene-0997")
    page.locator(".whole").wait_for()
    assert page.evaluate("document.querySelectorAll('.whole *').length") < 1_500


def test_what_models_wrote_stays_text(
    tab: Callable[..., Tab], judged: Study, tmp_path: Path
) -> None:
    study = Study(shutil.copytree(judged.folder, tmp_path / "copy"))
    bad = HOSTILE.replace("\x00", "").replace("\x1b", "")
    link = "javascript:alert(3)"
    verdicts = [
        verdict.model_copy(
            update={
                "model": f"{bad}m", "id": f"{verdict.scene_id}@{bad}m", "aspect": bad, "reasoning": link,
                "descriptions": (bad, link, "\u202egnp.exe"), "notes": (bad,), "contradiction": bad,
                "choice": bad, "error": bad,
            }
        )
        if verdict.kind == "model" else verdict
        for verdict in study.verdicts
    ]  # fmt: skip
    study.store.write_lines("verdicts.jsonl", as_made(study, verdicts))
    scenarios = [
        scenario.model_copy(update={"text": bad, "ordinary": bad}) for scenario in study.scenarios
    ]
    study.store.write_lines("scenarios.jsonl", scenarios)
    lines = (study.folder / "verdicts.jsonl").read_text("utf-8")
    (study.folder / "verdicts.jsonl").write_text(lines.replace("gnp.exe", "\\u0000gnp"), "utf-8")
    study.write_report()
    one = tab()
    page = one.open(report(study))
    for link in ("", f"#scene-{study.scenes[1].id}", f"#scene-{study.scenes[2].id}"):
        page.goto(f"{report(study).as_uri()}{link}")
        page.evaluate("document.querySelectorAll('details').forEach(box => { box.open = true })")
        assert (
            page.evaluate(
                "[...document.querySelectorAll('*')].filter(node => [...node.attributes].some(a => a.name.startsWith('on')"
                " || /^\\s*javascript:/i.test(a.value))).map(node => node.outerHTML)"
            )
            == []
        )
        assert one.count("script") == 2
        assert one.count("style") == 1
        assert page.locator("img[src=x]").count() == 0
    assert "<script>alert" in page.locator(".whole").inner_text()
    assert one.complaints == []


def test_it_prints_one_scene_without_its_controls(tab: Callable[..., Tab], judged: Study) -> None:
    one = tab()
    page = one.open(report(judged), f"#scene-{first(judged)}")
    page.emulate_media(media="print")
    assert page.locator(".steps").is_hidden()
    assert page.locator(".whole h2").is_visible()


def test_on_paper_nothing_is_cut_off_and_what_is_folded_is_seen(
    tab: Callable[..., Tab], judged: Study
) -> None:
    one = tab(viewport={"width": 720, "height": 1000})
    page = one.open(report(judged))
    page.emulate_media(media="print")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert page.locator("#models details:not([open])").count() == 0
    assert page.evaluate("document.documentElement.scrollWidth") <= 720
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    assert page.locator("#models details:not([open])").count() > 0


def test_a_missing_picture_is_said(tab: Callable[..., Tab], judged: Study, tmp_path: Path) -> None:
    alone = tmp_path / "report.html"
    shutil.copy(report(judged), alone)
    one = tab()
    page = one.open(alone, f"#scene-{first(judged)}")
    page.locator(".noframe").first.wait_for()
    assert "no picture beside this page" in page.locator(".whole").inner_text()


def test_every_control_has_a_name(tab: Callable[..., Tab], judged: Study) -> None:
    page = tab().open(report(judged))
    nameless = page.evaluate(
        "[...document.querySelectorAll('a, button, input, select, summary, [role=region], img, svg[role=img]')].filter(node =>"
        " !(node.textContent.trim() || node.labels?.length || node.getAttribute('aria-label') || node.alt || node.querySelector('img[alt]'))).map(node => node.outerHTML)"
    )
    assert nameless == []


def test_the_embedded_document_is_what_the_page_shows(judged: Study) -> None:
    source = report(judged).read_text("utf-8")
    found = source.partition('id="data">')[2].partition("</script>")[0]
    assert "<" not in found
    assert len(json.loads(found)["scenes"]) == 9


def answer_a_drive(page: Any) -> None:
    page.locator("input[value=no]").check()
    page.locator("input[name=level]").first.check()
    for _ in range(2):
        page.locator("#go").click()
        page.locator("#choices input").first.check()
    page.locator("#go").click()


def test_everybody_begins_a_quiz_anew_and_goes_on_with_the_own_answers(
    tab: Callable[..., Tab], judged: Study, tmp_path: Path
) -> None:
    one = tab()
    page = one.open(write_quiz(judged, tmp_path / "quiz.html", scenes=2))
    for name in ("Ada", "José 李"):
        page.locator("#name").fill(name)
        playwright.expect(page.locator("#go")).to_have_text("Start")
        page.locator("#go").click()
        answer_a_drive(page)
        playwright.expect(page.locator("#where")).to_contain_text("Drive 2 of 4")
        page.reload()
        playwright.expect(page.locator("#name")).to_have_value(name)
        playwright.expect(page.locator("#go")).to_have_text(f"Go on as {name}")
        with page.expect_download() as saved:
            page.locator("#save").click()
        answers = json.loads(Path(saved.value.path()).read_text("utf-8"))
        assert (answers["id"], len(answers["answers"])) == (name, 1)
    page.goto(write_quiz(judged, tmp_path / "fewer.html", scenes=1).as_uri())
    page.locator("#name").fill("Ada")
    playwright.expect(page.locator("#go")).to_have_text("Start")
    assert one.complaints == []


@pytest.mark.parametrize("name", ["O'Brien", " Ada", "a/b", "-" * 41])
def test_a_name_that_no_study_takes_is_told_so(
    tab: Callable[..., Tab], judged: Study, tmp_path: Path, name: str
) -> None:
    page = tab().open(write_quiz(judged, tmp_path / "quiz.html", scenes=1))
    page.locator("#name").fill("Zoë")
    playwright.expect(page.locator("#unfit")).to_be_hidden()
    playwright.expect(page.locator("#go")).to_be_enabled()
    page.locator("#name").evaluate("(box, name) => { box.value = name }", name)
    page.locator("#name").dispatch_event("input")
    playwright.expect(page.locator("#unfit")).to_be_visible()
    playwright.expect(page.locator("#go")).to_be_disabled()
