"""Every option and argument of every command with values that no user means: one line, or a sensible run."""

import sys
from collections.abc import Iterator
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from oodscen._cli import main
from oodscen.testing._scenes import example_scene

VALUES = [
    *("nan", "-inf", "1e308", str(10**30), "-1", "0", "", "a\0b", "\udcff"),
    *("9" * 5_000, "x" * 10_000),
]
TREE = (
    '{"nodes":[{"id":"root","parent":null,"label":"OOD"},'
    '{"id":"deer","parent":"root","label":"A deer on the road"}]}'
)
CHEAP = {
    "run": ["out", "--quick", "--simulator", "flat", "--encoder", "unknown"],
    "init": [],
    "show": ["."],
    "completion": ["bash"],
    "grow": ["--nodes", "12"],
    "redteam": ["tree.json", "--iterations", "1", "--encoder", "none"],
    "prune": ["tree.json", "--simulator", "flat"],
    "describe": ["tree.json", "--per-path", "1"],
    "augment": ["empty", "--simulator", "flat", "--encoder", "none"],
    "check-claims": [
        *("scene.jsonl", "--scenarios", "texts.jsonl"),
        *("--simulator", "flat", "--encoder", "none"),
    ],
    "simulate": ["empty", "out", "--simulator", "flat"],
    "evaluate": ["."],
    "quiz": ["."],
    "publish": [".", "-o", "data"],
    "drive": ["."],
    "serve": ["empty", "--carla", "0"],
    "score": ["texts.txt", "--baseline", "texts.txt", "--encoder", "hash"],
    "power": ["0.66", "0.51"],
    "report": ["."],
    "audit": ["."],
    "export": ["empty", "-o", "out", "--simulator", "flat"],
    "import": ["file", "--simulator", "flat"],
    "verdict": ["empty", "file", "--simulator", "flat"],
    "vary": ["empty", "--simulator", "flat"],
    "props": ["file", "--simulator", "flat"],
    "plugins": [],
    "doctor": ["knowledge", "empty"],
    "new adapter": ["mine"],
    "tree show": ["tree.json"],
    "tree diff": ["tree.json", "tree.json"],
    "tree merge": ["tree.json", "tree.json"],
    "tree coverage": ["."],
    "tree export": ["tree.json"],
    "tree replay": ["tree.json"],
}
"""Arguments with which a command ends soon: it does something small, or refuses what it is given."""


TRAFFIC = {"max_cost", "max_seconds", "timeout", "patience", "prices", "concurrency"}
"""What the limits of models is held to is tested with it."""


def commands(group: click.Group, path: str = "") -> Iterator[tuple[str, click.Command]]:
    for name, command in group.commands.items():
        if isinstance(command, click.Group):
            yield from commands(command, f"{name} ")
        else:
            yield path + name, command


COMMANDS = dict(commands(main))


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "tree.json").write_text(TREE)
    (tmp_path / "texts.txt").write_text("A deer.\nA sofa.\nA car waits.\n")
    (tmp_path / "texts.jsonl").write_text('{"id":"example","text":"A deer stands on the road."}\n')
    (tmp_path / "scene.jsonl").write_text(example_scene().to_json() + "\n")
    (tmp_path / "empty").write_text("")
    (tmp_path / "file").write_text("")
    monkeypatch.chdir(tmp_path)
    # Importing it takes longer than all of this; without it a model's name is refused the sooner.
    monkeypatch.setitem(sys.modules, "litellm", None)
    return tmp_path


def without(option: click.Option, given: list[str]) -> list[str]:
    """Return the arguments without an option and its value."""
    at = next((index for index, word in enumerate(given) if word in option.opts), None)
    return given if at is None else [*given[:at], *given[at + 1 + option.nargs :]]


def orders(name: str, value: str) -> Iterator[list[str]]:
    """Yield a command line for every option and argument that gets a value."""
    given = CHEAP[name]
    arguments = 0
    for param in COMMANDS[name].params:
        if isinstance(param, click.Argument):
            words = [*given[:arguments], value, *given[arguments + 1 :]]
            arguments += 1
        elif not param.is_flag and param.name not in TRAFFIC:
            words = [param.opts[0], *[value] * param.nargs, *without(param, given)]
        else:
            continue
        yield [*name.split(), *words]


def test_there_is_a_cheap_order_for_every_command() -> None:
    assert set(COMMANDS) == set(CHEAP)


@pytest.mark.parametrize("value", VALUES, ids=lambda value: repr(value)[:12])
@pytest.mark.parametrize("name", COMMANDS)
def test_a_strange_value_is_one_line_or_a_sensible_run(name, value, folder) -> None:
    for order in orders(name, value):
        result = CliRunner().invoke(main, order)
        assert result.exception is None or isinstance(result.exception, SystemExit), order[:9]
        assert result.exit_code in (0, 1, 2), order[:9]
        if result.exit_code == 2:
            said = [line for line in result.stderr.splitlines() if not line.startswith("  - ")]
            (line,) = (line for line in said if line.startswith(("Error: ", "oodscen: ")))
            assert said[-1] == line, said
            assert max(map(len, said)) < 1_200
        if "\0" in value or value == "\udcff":
            assert result.exit_code == 2


IDLE = [
    ("tree diff tree.json tree.json --threshold 0.5", "--threshold"),
    ("tree merge tree.json tree.json --threshold 0.5 -o new", "--threshold"),
    ("tree diff tree.json tree.json --json --mermaid", "--mermaid"),
    ("tree show tree.json --ids --json", "--ids"),
    ("tree show tree.json --ids --node deer", "--ids"),
    ("tree show tree.json --which diverse", "--which"),
    ("tree export tree.json --which initial", "--which"),
    ("tree diff tree.json tree.json --which initial", "--which"),
    ("tree replay tree.json --json -o new", "--json"),
    ("show study --moment last", "--moment"),
    ("show study --graphics none --json", "--graphics"),
    ("show study example --json --moment nosuch", "--moment"),
    ("show study example --moment last", "--moment"),
    ("export scene.jsonl -o new --to osi --mode replay", "--mode"),
    ("export scene.jsonl -o new --to mcap --for esmini --logical", "--for and --logical"),
    ("export scene.jsonl -o new --to rerun --no-ego", "--no-ego"),
    ("export scene.jsonl -o new --to openlabel --action stop", "--action"),
    ("export scene.jsonl -o new --mode reactive --action stop", "--action"),
    ("import file --llm constant:stop --hazard x", "--llm"),
    ("import file --llm builtin --api-base http://host", "--api-base"),
    ("verdict scene.jsonl file --replace", "--replace"),
    ("verdict scene.jsonl file --driver mine --replace", "--replace"),
    ("verdict study file --replace", "--replace"),
    ("props --details --captions", "--captions"),
    ("prune tree.json --catalogue carla-0.9.16 --simulator flat", "--simulator"),
    ("prune tree.json --simulator flat --json", "--json"),
    ("prune tree.json --simulator flat --api-base http://host", "--api-base"),
    ("grow --api-base http://host", "--api-base"),
    ("redteam tree.json --api-base http://host --red-llm builtin", "--api-base"),
    ("redteam tree.json --open-loop --encoder none", "--encoder"),
    (
        "redteam tree.json --open-loop --nearest 0.9 --nearest-label 0.9",
        "--nearest and --nearest-label",
    ),
    ("redteam tree.json --open-loop --rarity 1 2 --broadenings 1", "--rarity and --broadenings"),
    ("describe tree.json --baseline texts.txt", "--baseline"),
    ("describe tree.json --api-base http://host", "--api-base"),
    ("augment texts.jsonl --no-claims --encoder none", "--encoder"),
    ("augment texts.jsonl --api-base http://host", "--api-base"),
    ("check-claims scene.jsonl --scenarios texts.jsonl --api-base http://host", "--api-base"),
    ("score texts.txt --api-base http://host", "--api-base"),
    ("score texts.txt --llm builtin --api-base http://host", "--api-base"),
    ("power 0.6 0.5 --unpaired --agreement 0.1", "--agreement"),
    ("doctor --quick", "--quick"),
    ("doctor knowledge --states-only", "--states-only"),
    ("publish study -o new --to none --to drivelm", "--to none"),
    ("evaluate study --retry-failed --api-base http://host", "--api-base"),
    ("evaluate study --vlm random --judge replay:x --api-base http://host", "--api-base"),
    ("grow --llm random --api-base http://host", "--api-base"),
    ("evaluate study --vlm constant:stop --retry-failed --dry-run", "--retry-failed"),
    ("run new --quick --without-pictures", "--without-pictures"),
    ("run new --quick --recogniser nobody", "--recogniser"),
    ("run new --quick --llm nobody --no-made --recogniser nobody", "--recogniser"),
    ("run new --quick --dry-run --retry-failed", "--retry-failed"),
    ("run new --quick --open-loop --broadenings 1", "--broadenings"),
]
"""Orders with an option that would do nothing beside the others, and its name."""


@pytest.mark.parametrize(("order", "named"), IDLE, ids=[order for order, _ in IDLE])
def test_an_option_that_would_do_nothing_is_refused(order, named, folder) -> None:
    (folder / "study").mkdir()
    (folder / "study" / "study.json").write_text('{"config": {"simulator": "flat"}}')
    (folder / "study" / "scenes.jsonl").write_text(example_scene().to_json() + "\n")
    before = sorted(folder.rglob("*"))
    done = CliRunner().invoke(main, order.split())
    assert (done.exit_code, done.stdout, len(done.stderr.splitlines())) == (2, "", 1), done.output
    assert f"oodscen: {named} " in done.stderr
    assert sorted(folder.rglob("*")) == before


def test_a_switch_that_a_file_leaves_off_is_not_refused(folder) -> None:
    (folder / "run.toml").write_text("without-pictures = false\nllm = 'nobody'\n")
    done = CliRunner().invoke(main, ["run", "new", "--config", "run.toml"])
    assert "litellm" in done.stderr
    (folder / "run.toml").write_text("without-pictures = true\n")
    done = CliRunner().invoke(main, ["run", "new", "--config", "run.toml"])
    assert "--without-pictures has no effect without --vlm" in done.stderr


def with_a_value(option: click.Option) -> list[str]:
    return [option.opts[-1], *["1"] * option.nargs]


@pytest.mark.parametrize("name", COMMANDS)
def test_an_option_of_one_value_is_given_once(name, folder) -> None:
    before = sorted(folder.rglob("*"))
    options = [param for param in COMMANDS[name].params if isinstance(param, click.Option)]
    for option in options:
        if option.multiple or option.is_flag:
            continue
        for other in options[:2]:
            between = [] if option is other or other.is_flag else with_a_value(other)
            twice = [*with_a_value(option), *between, *with_a_value(option)]
            done = CliRunner().invoke(main, [*name.split(), *twice])
            assert (done.exit_code, done.stdout) == (2, ""), twice
            assert done.stderr == (
                f"oodscen: {option.opts[-1]} is given more than once; give one value\n"
            )
    assert sorted(folder.rglob("*")) == before


@pytest.mark.parametrize(
    "order", ["plugins --json --json", "show . --json --json", "power 0.66 0.51 --json --json"]
)
def test_a_switch_may_be_repeated(order, folder) -> None:
    assert "more than once" not in CliRunner().invoke(main, order.split()).output


def test_both_ways_to_give_a_value_count(folder) -> None:
    order = ["export", "empty", "-o", "a", "--to=osi", "--out", "b", "--to", "mcap"]
    done = CliRunner().invoke(main, order)
    assert done.stderr == ("oodscen: --out and --to are given more than once; give one value\n")
