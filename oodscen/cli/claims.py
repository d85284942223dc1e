"""Whether scenes hold to their texts."""

import sys
from pathlib import Path

import click
from tqdm import tqdm

from oodscen._data import canonical_json
from oodscen.cli.options import READABLE, json_option, llm_options, seed_option, simulator_option
from oodscen.cli.output import read_lines, say
from oodscen.errors import DataError, Issue


@click.command()
@click.argument("scenes", type=READABLE)
@click.option(
    "--scenarios", type=READABLE, required=True, help="The texts, one scenario per line, by id."
)
@llm_options
@seed_option
@simulator_option
@json_option
def faithful(
    scenes: Path,
    scenarios: Path,
    llm: str,
    api_base: str | None,
    seed: int,
    simulator: str,
    as_json: bool,
) -> None:
    """Compare every scene of the file SCENES, whoever wrote it, with what its text says.

    The exit code is 1 if a scene contradicts its text or cannot be staged.
    """
    from oodscen import Scenario, Scene, make_llm, make_simulator
    from oodscen.claims import check_faithful
    from oodscen.driving import check_scene

    texts = {scenario.id: scenario.text for scenario in read_lines(Scenario, scenarios)}
    items = read_lines(Scene, scenes)
    missing = [scene.scenario_id for scene in items if scene.scenario_id not in texts]
    if missing:
        issues = [Issue("scenario_id", f"{scenarios} has no text {name!r}") for name in missing]
        raise DataError("scenes", issues, source=str(scenes))
    model = make_llm(llm, seed=seed, api_base=api_base)
    catalogue = make_simulator(simulator).catalogue()
    rows, failures, claims = [], 0, 0
    for scene in tqdm(items, desc="faithful", disable=None):
        faults = check_scene(scene, catalogue)
        if faults:
            failures += 1
            rows.append({"id": scene.id, "faults": [str(issue) for issue in faults]})
            continue
        told = check_faithful(model, texts[scene.scenario_id], scene, catalogue)
        failures += not told.is_faithful
        claims += len(told.findings)
        rows.append(told.model_dump(mode="json"))
        if not as_json:
            for one in told.mismatches:
                say(f"{scene.id}: the text says {one.claim}, but {one.found}")
    if as_json:
        say(canonical_json({"scenes": rows, "claims": claims, "unfaithful": failures}))
    else:
        for row in rows:
            for fault in row.get("faults", ()):
                say(f"{row['id']}: {fault}")
        say(f"{len(items)} scenes, {claims} claims, {failures} scenes that do not hold to them")
    sys.exit(bool(failures))
