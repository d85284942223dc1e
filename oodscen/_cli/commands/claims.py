"""The command that compares scenes with their texts."""

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import click

from oodscen._cli.options import (
    json_option,
    llm_options,
    refuse_idle_server,
    seed_option,
    simulator_option,
    things_encoder,
    things_option,
)
from oodscen._cli.output import if_stopped, say
from oodscen._cli.paths import READABLE
from oodscen._cli.progress import tracked
from oodscen._io.files import read_utf8
from oodscen.data._base import Data, canonical_json
from oodscen.errors import AnswerError, DataError, Issue, LLMError, UsageError

if TYPE_CHECKING:
    from oodscen.claims._faithfulness import Faithfulness
    from oodscen.data._scene import Scene

Value = TypeVar("Value", bound=Data)


class Unjudged(Data):
    """A line of a file that could not be compared with a text."""

    id: str
    """Id of the scene, or the file and line number if the line holds no scene."""
    faults: tuple[str, ...]
    """Reasons why the line could not be compared."""


@click.command("check-claims")
@click.argument("scenes", type=READABLE)
@click.option(
    "--scenarios", type=READABLE, required=True, help="File of the texts, one scenario per line."
)
@llm_options
@seed_option
@simulator_option
@things_option
@json_option
def check_claims(
    scenes: Path,
    scenarios: Path,
    llm: str,
    api_base: str | None,
    seed: int,
    simulator: str,
    encoder: str,
    as_json: bool,
) -> None:
    """Check every scene of the file SCENES against the claims of its text.

    Scenes from any source are accepted; one that is given twice counts once. An ordinary demand is compared with
    its own text. Malformed lines, scenes without a text and scenes that cannot be staged are reported and counted,
    not checked. The exit code is 1 if there are any, or if a scene contradicts its text.
    """
    from oodscen import Scene, make_llm, make_simulator
    from oodscen.claims._faithfulness import Faithfulness, compare_text
    from oodscen.llm._accounting import Ledger

    refuse_idle_server(llm)
    texts, malformed = _texts(scenarios)
    ledger = Ledger()
    model = make_llm(llm, seed=seed, api_base=api_base, log=ledger.add)
    catalogue = make_simulator(simulator).catalogue()
    measure = things_encoder(encoder)

    def compared(number: int, scene: Scene | tuple[str, ...]) -> Faithfulness | Unjudged:
        if not isinstance(scene, Scene):
            return Unjudged(id=f"{scenes.name}:{number}", faults=scene)
        faults = [str(issue) for issue in scene.check(catalogue)]
        text = scene.demand.text if scene.demand else texts.get(scene.scenario_id)
        if text is None:
            faults.insert(0, f"{scenarios} has no text {scene.scenario_id!r}")
        if text is None or faults:
            return Unjudged(id=scene.id, faults=tuple(faults))
        try:
            return compare_text(model, text, scene, catalogue, encoder=measure)
        except (AnswerError, LLMError) as error:
            return Unjudged(id=scene.id, faults=(str(error),))

    rows: list[Faithfulness | Unjudged] = [*malformed]
    lines = _distinct_scenes(scenes)
    with if_stopped(rows, lambda: _print(rows, as_json=as_json)):
        for number, scene in tracked(lines, "check-claims", len(lines), ledger):
            rows.append(compared(number, scene))
    sys.exit(bool(_print(rows, as_json=as_json)))


def _texts(path: Path) -> tuple[dict[str, str], list[Unjudged]]:
    """Return the texts of a file by id, and its malformed lines.

    Raises:
        UsageError: If two different texts have one id.
    """
    from oodscen.data._scenario import Scenario

    texts: dict[str, str] = {}
    malformed: list[Unjudged] = []
    for number, scenario in _values(Scenario, path):
        if not isinstance(scenario, Scenario):
            malformed.append(Unjudged(id=f"{path.name}:{number}", faults=scenario))
        elif texts.setdefault(scenario.id, scenario.text) != scenario.text:
            raise UsageError(f"{path}, line {number}: there is another text {scenario.id!r}")
    return texts, malformed


def _distinct_scenes(path: Path) -> "list[tuple[int, Scene | tuple[str, ...]]]":
    """Return the scenes of a file, or the faults of malformed lines, without scenes that repeat an earlier one.

    Raises:
        UsageError: If two different scenes have one id.
    """
    from oodscen.data._scene import Scene

    by_id: dict[str, Scene] = {}
    lines: list[tuple[int, Scene | tuple[str, ...]]] = []
    for number, scene in _values(Scene, path):
        if isinstance(scene, Scene):
            if scene.id in by_id:
                if scene != by_id[scene.id]:
                    raise UsageError(f"{path}, line {number}: there is another scene {scene.id!r}")
                continue
            by_id[scene.id] = scene
        lines.append((number, scene))
    return lines


def _print(rows: "Sequence[Faithfulness | Unjudged]", *, as_json: bool) -> int:
    """Print the rows, and return the number of scenes that are unfaithful or could not be checked."""
    from oodscen.claims._faithfulness import Faithfulness

    judged = [row for row in rows if isinstance(row, Faithfulness)]
    unjudged = [row for row in rows if isinstance(row, Unjudged)]
    claims = sum(len(row.findings) for row in judged)
    unfaithful = sum(not row.is_faithful for row in judged)
    faults = unfaithful + len(unjudged)
    if as_json:
        content = [row.model_dump(mode="json") for row in rows]
        say(canonical_json({"scenes": content, "claims": claims, "unfaithful": faults}))
        return faults
    for faithfulness in judged:
        for mismatch in faithfulness.mismatches:
            say(f"{faithfulness.id}: the text says {mismatch.claim}, but {mismatch.found}")
    for row in unjudged:
        for fault in row.faults:
            say(f"{row.id}: {fault}")
    unchecked = f"; {len(unjudged)} more could not be checked" if unjudged else ""
    say(f"{len(judged)} scenes, {claims} claims, {unfaithful} unfaithful scenes{unchecked}")
    return faults


def _values(kind: type[Value], path: Path) -> Iterator[tuple[int, Value | tuple[str, ...]]]:
    """Yield one value per line with the line's number, or the faults of a malformed line.

    Raises:
        DataError: When the file has no line, or is not text.
    """
    lines = read_utf8(path, kind.noun).split("\n")
    if not any(map(str.strip, lines)):
        raise DataError(kind.noun, [Issue("", f"holds no {kind.noun}")], source=str(path))
    for number, line in enumerate(lines, start=1):
        if line.strip():
            try:
                yield number, kind.parse(line)
            except DataError as error:
                yield number, tuple(f"no {kind.noun}: {issue}" for issue in error.issues)
