"""Renders the page: escaped by default, sealed by a content security policy."""

import base64
import hashlib
import json
import re
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup, escape

from oodscen._arguments import checked
from oodscen._io.files import bundled
from oodscen.errors import FolderTaken
from oodscen.judging._leaderboard.requirements import Bar
from oodscen.judging._leaderboard.rows import Estimate, Rate
from oodscen.report._charts import scores as charts
from oodscen.report._charts.canvas import Canvas, signed
from oodscen.report._load import read
from oodscen.report._page import page_variables
from oodscen.report._phrasing import duration, p_value
from oodscen.report._sections import RenderedPart
from oodscen.study._study import Study

FILE = "report.html"
"""Name of the page in the study's folder."""


@checked
def write_report(
    study: Study, bars: Sequence[Bar] = (), *, warn: Callable[[str], None] | None = None
) -> Path:
    """Write `report.html` into a study's folder and return its path; `Study.write_report` tells errors.

    `bars` are a requirement on the judged models, whose grades the page shows.
    """
    if FILE in study.own() and not study.store.has("study.json"):
        raise FolderTaken(str(study.folder), [FILE])
    with study.store.writing():
        material = read(study)
        html = render(page_variables(study, material, bars))
        study.store.write(FILE, html.encode("utf-8"))
    if warn is not None:
        for note in material.gaps.values():
            warn(note)
    return study.folder / FILE


def render(variables: dict[str, Any]) -> str:
    """Return the filled template; everything that is not markup made here is escaped."""
    style, script = _source("style.css"), _source("script.js")
    own = {
        "payload": embed_json(variables["payload"]),
        "style": Markup(style),
        "script": Markup(script),
        "style_hash": _hash(style),
        "script_hash": _hash(script),
    }
    return environment().get_template("page.html.j2").render(variables | own)


def embed_json(value: Any) -> Markup:
    """Return plain data as JSON that is safe inside a script element."""
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    for char in "<>&\u2028\u2029":
        text = text.replace(char, f"\\u{ord(char):04x}")
    return Markup(text)


@cache
def environment() -> jinja2.Environment:
    """Return the environment of the templates."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("oodscen.report", "templates"),
        undefined=jinja2.StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["breakable"] = _breakable
    environment.filters["percent"] = lambda share: f"{100 * share:.0f} %"
    environment.filters["hundredths"] = lambda share: f"{100 * share:.0f}"
    environment.filters["signed"] = signed
    environment.filters["p_value"] = p_value
    environment.filters["plural"] = lambda n, noun: f"{n} {noun}{'' if n == 1 else 's'}"
    environment.filters["duration"] = duration
    environment.filters["thousands"] = lambda value: f"{value:,}".replace(",", "\N{THIN SPACE}")
    environment.globals["shares"] = lambda row: charts.shares(
        [(kind, getattr(row, kind)) for kind in ("safe", "marginal", "unsafe", "unavailable")]
    )
    environment.globals["whisker"] = _whisker
    environment.globals["rendered"] = render_part
    return environment


def render_part(part: RenderedPart) -> Markup:
    """Return a part of the page; its template sees its own data alone."""
    template = environment().get_template(f"parts/{part.template}.html.j2")
    return Markup(template.render(part.data))


def _whisker(figure: Rate | Estimate) -> Canvas:
    """Draw a known figure with its interval; without one, the figure alone."""
    value = figure.value or 0.0
    low, high = (figure.interval.low, figure.interval.high) if figure.interval else (value, value)
    return charts.whisker(value, low, high)


def _breakable(name: str) -> Markup:
    """Return a name with line break opportunities after its punctuation marks."""
    return Markup(re.sub(r"([:_/@])", r"\1<wbr>", str(escape(name))))


def _source(name: str) -> str:
    return bundled(name, "oodscen.report")


def _hash(source: str) -> str:
    """Return the hash that identifies an inline block in a content security policy."""
    digest = hashlib.sha256(source.encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode('ascii')}'"
