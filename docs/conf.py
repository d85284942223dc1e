"""Configures the site; `make docs` builds it from the pages as they are.

Pages that GitHub shows by other means are written into `docs/generated` first: the reference of the
public names that `api.md` lists, the examples, and the changelog.
"""

import importlib
import inspect
import re
import shutil
from pathlib import Path
from typing import Any

from sphinx.ext.napoleon import Config, GoogleDocstring

DOCS = Path(__file__).parent
ROOT = DOCS.parent
GENERATED = DOCS / "generated"
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
NOTEBOOKS = sorted((ROOT / "examples" / "notebooks").glob("*.ipynb"))

project = "oodscen"
author = copyright = "The oodscen contributors"
extensions = ["myst_parser", "sphinx.ext.autodoc"]
root_doc = "index"
exclude_patterns = ["_build"]
default_role = "literal"  # docstrings put code between single backquotes
nitpicky = False

myst_heading_anchors = 4
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_default_options = {
    "members": True,
    "exclude-members": "model_config, model_post_init, noun, __init__, __new__",
}
python_use_unqualified_type_names = True
add_module_names = False

html_theme = "furo"
html_title = "oodscen"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False

SECTION = re.compile(r"^## `([\w.]+)`\n\n([^\n]*)\n\n([^\n]*)$", re.MULTILINE)
"""A package of `api.md`, its line and its names."""

LIMITED = re.compile(
    r"(?:~?typing\.)?Annotated\[([~\w.]+), (?:[~\w.]+\((?:[^()']|'[^']*')*\)(?:, )?)+\]"
)
"""A type with limits in a signature."""


def _slug(heading: str) -> str:
    """Return the anchor of a heading, as GitHub makes it."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def _entry(package: str, name: str) -> str:
    """Return the directive that documents a public name."""
    value = getattr(importlib.import_module(package), name)
    if inspect.isclass(value):
        kind = "exception" if issubclass(value, BaseException) else "class"
        return f".. auto{kind}:: {package}.{name}\n"
    if inspect.isroutine(value):
        return f".. autofunction:: {package}.{name}\n"
    return f".. py:data:: {package}.{name}\n"


def _write_reference(folder: Path) -> None:
    """Write a page per package of `api.md`; names that `oodscen` repeats are described elsewhere."""
    folder.mkdir(parents=True)
    packages = SECTION.findall((DOCS / "api.md").read_text("utf-8"))
    for package, line, listing in packages:
        elsewhere = {
            name: other
            for other, _, names in packages
            if other != package == "oodscen"
            for name in re.findall(r"`(\w+)`", names)
        }
        words = re.sub(r" \(\[.*?\]\(.*?\)\)", "", line)
        parts = [f"{package}\n{'=' * len(package)}\n\n{words}\n"]
        for name in re.findall(r"`(\w+)`", listing):
            other = elsewhere.get(name)
            link = f"* `{name}`: see :doc:`{other}`\n"
            parts.append(link if other else _entry(package, name))
        (folder / f"{package}.rst").write_text("\n".join(parts), "utf-8")


def _write_examples(file: Path) -> None:
    """Write the page of all examples."""
    parts = ["# Examples\n\nRead and copy whole programs; the tests run each of them."]
    for path in EXAMPLES:
        code = path.read_text("utf-8")
        parts.append(f"## {path.name}\n\n```python\n{code}```")
    code = (ROOT / "examples" / "carla" / "actions.py").read_text("utf-8")
    parts.append(f"## carla\n\n### actions.py\n\n```python\n{code}```")
    for name in ("driving_ci", "recorded"):
        text = (ROOT / "examples" / name / "README.md").read_text("utf-8")
        text = re.sub(r"\]\((?:\.\./)+docs/", "](../", text)
        parts.append(f"## {name}\n\n" + re.sub(r"^#", "##", text, flags=re.MULTILINE))
    parts.append("## notebooks\n\nDownload them with their outputs:")
    for path in NOTEBOOKS:
        shutil.copy(path, GENERATED)
        parts.append(f"- [{path.stem}]({path.name})")
    designs = sorted(path.stem for path in (ROOT / "examples" / "made").glob("*.json"))
    listing = ", ".join(f"`{name}`" for name in designs)
    parts.append(f"## made\n\nDesigns of [things made to order](../made.md): {listing}.")
    file.write_text("\n\n".join(parts) + "\n", "utf-8")


def _generate(app: Any) -> None:
    shutil.rmtree(GENERATED, ignore_errors=True)
    _write_reference(GENERATED / "api")
    _write_examples(GENERATED / "examples.md")
    changes = (ROOT / "CHANGELOG.md").read_text("utf-8").replace("](docs/", "](../")
    (GENERATED / "changelog.md").write_text(changes, "utf-8")


def _within_the_site(match: re.Match[str]) -> str:
    """Return a link out of `docs` as one to the page that shows its target here."""
    target = match[1].rstrip("/")
    if target == "CHANGELOG.md":
        return "](generated/changelog.md)"
    if target.startswith("examples"):
        part = target.split("/")[1] if "/" in target else "examples"
        return f"](generated/examples.md#{_slug(part)})"
    raise ValueError(f"the site has no page for {target}")


def _read(app: Any, page: str, source: list[str]) -> None:
    if "/" not in page:
        source[0] = re.sub(r"\]\(\.\./([^)#]+)\)", _within_the_site, source[0])
    if page == "api":
        source[0] += "\n```{toctree}\n:hidden:\n:glob:\n\ngenerated/api/*\n```\n"
        source[0] = re.sub(
            r"^## `([\w.]+)`$", r"## [`\1`](generated/api/\1.rst)", source[0], flags=re.MULTILINE
        )


def _google_style(
    app: Any, what: str, name: str, value: Any, options: Any, lines: list[str]
) -> None:
    """Read sections of a docstring; those of fields have none, though they may have a colon."""
    if "Attributes:" in lines:  # `help` lists the fields there; here each has an entry
        del lines[lines.index("Attributes:") :]
    if what not in {"attribute", "data", "property"}:
        style = Config(napoleon_use_ivar=True)
        lines[:] = GoogleDocstring(lines, style, app, what, name, value, options).lines()


def _plain_types(
    app: Any, what: str, name: str, value: Any, options: Any, signature: str, returned: str
) -> tuple[str, str] | None:
    """Drop the limits of pydantic fields from a signature, which is long enough."""
    return (LIMITED.sub(r"\1", signature), returned) if signature else None


def setup(app: Any) -> None:
    """Write the generated pages before the build, and turn links out of `docs` to them."""
    app.connect("builder-inited", _generate)
    app.connect("source-read", _read)
    app.connect("autodoc-process-docstring", _google_style)
    app.connect("autodoc-process-signature", _plain_types)
