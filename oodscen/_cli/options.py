"""Options shared by several commands."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from oodscen._cli.commands.completion import ComponentName
from oodscen._cli.numbers import SHARE, FiniteRange
from oodscen._cli.paths import OutputName
from oodscen._entry_points import DEFAULT_LLM, is_asked, is_builtin
from oodscen._registry import DEFAULT_ENCODER, DEFAULT_SIMULATOR
from oodscen._seeding import MAX_SEED
from oodscen.data._reactions import LONGEST_REACTION_S, REACTIONS_S
from oodscen.errors import OodscenError, UsageError
from oodscen.llm._remote.budget import check_price
from oodscen.llm._remote.limits import LONGEST_S, TIMEOUT_S
from oodscen.llm._remote.rate_limit import PATIENCE_S
from oodscen.protocols import Camera
from oodscen.stages._redteam.thresholds import (
    BROADENINGS,
    MOST_IN_FLIGHT,
    NEAREST_LABEL,
    NEAREST_TEXT,
)

if TYPE_CHECKING:
    from oodscen.llm._remote.budget import Price
    from oodscen.llm._remote.limits import Limits
    from oodscen.protocols import Encoder

Command = Callable[..., Any]


def grouped_options(*decorators: Callable[[Command], Command]) -> Callable[[Command], Command]:
    """Return one decorator for several options, which help lists in this order."""

    def apply(function: Command) -> Command:
        for decorator in reversed(decorators):
            function = decorator(function)
        return function

    return apply


llm_options = grouped_options(
    click.option(
        "--llm",
        type=ComponentName("llm"),
        default=DEFAULT_LLM,
        show_default=True,
        help="Model: a litellm name, builtin, or replay:FILE.",
    ),
    click.option("--api-base", help="Address of an OpenAI-compatible server."),
)
seed_option = click.option(
    "--seed",
    default=0,
    show_default=True,
    type=click.IntRange(0, MAX_SEED),
    help="Seed of all random choices.",
)
run_seed_option = click.option(
    "--seed",
    type=click.IntRange(0, MAX_SEED),
    help="Seed of the runs.  [default: the study's own, 0 for a file]",
)
simulator_option = click.option(
    "--simulator",
    type=ComponentName("simulator"),
    default=DEFAULT_SIMULATOR,
    show_default=True,
    help="Simulator: a registered name, or module:attr.",
)
things_option = click.option(
    "--encoder",
    type=ComponentName("encoder"),
    default=DEFAULT_ENCODER,
    show_default=True,
    help="Text encoder that compares the things of a text with the actors said to show them; `none` compares words "
    "only.",
)
rollout_options = grouped_options(
    click.option(
        "--reaction",
        multiple=True,
        type=FiniteRange(0, LONGEST_REACTION_S),
        metavar="S",
        help="Reaction time of a driver who tries every action, in seconds; repeatable.  "
        f"[default: {', '.join(f'{reaction:g}' for reaction in REACTIONS_S)}]",
    ),
    click.option(
        "--horizon",
        type=FiniteRange(0, 60, min_open=True),
        metavar="S",
        help="Time for which an action is watched, in seconds.  [default: the scene's own]",
    ),
)


def refuse_idle(reason: str, *names: str) -> None:
    """Refuse options of the running command that were given and would be ignored.

    Args:
        reason: The end of the sentence that they have no effect, e.g. `without --encoder`.
        names: The parameters of the options.

    Raises:
        UsageError: If one of them was given, also with the value of its default; a switch that a file leaves off
            was not.
    """
    context = click.get_current_context()
    idle = []
    for param in context.command.params:
        if param.name not in names or param.name is None:
            continue
        source, value = context.get_parameter_source(param.name), context.params[param.name]
        words = param.secondary_opts if value is False else param.opts
        if source not in (None, ParameterSource.DEFAULT) and words:
            idle.append(words[-1])
    if idle:
        has = "has" if len(idle) == 1 else "have"
        raise UsageError(f"{' and '.join(idle)} {has} no effect {reason}")


def refuse_idle_server(*models: str | None) -> None:
    """Refuse an address of a server if none of the models has one: the built-in author, references and recordings.

    Raises:
        UsageError: If `--api-base` was given for no model that it would reach.
    """
    named = [model for model in models if model is not None]
    if not any(map(is_asked, named)):
        is_author = all(map(is_builtin, named))
        whom = "the built-in author; name a model with --llm" if is_author else " and ".join(named)
        refuse_idle(f"on {whom}", "api_base")


def refuse_idle_prices(
    limits: "Limits", models: Iterable[str], servers: Mapping[str, str | None]
) -> None:
    """Refuse a price of a model that a command does not ask.

    Args:
        limits: Their prices.
        models: The names of the models that may be asked.
        servers: Addresses by model, where one is given.

    Raises:
        UsageError: If `--price` names one, with the models that are asked.
    """
    from oodscen._registry import make_llm

    asked = [*filter(is_asked, models)]
    names = set(asked)
    if limits.prices.keys() - names:
        for model in asked:
            # A class may have another name than that by which it is asked for.
            with suppress(OodscenError):
                names.add(make_llm(model, api_base=servers.get(model)).name)
    if idle := [name for name in limits.prices if name not in names]:
        others = (
            f"its models are {', '.join(sorted(names))}" if names else "it asks none with a price"
        )
        raise UsageError(
            f"--price has no effect for {', '.join(idle)}, which is not asked: {others}"
        )


def refuse_idle_in_open_loop() -> None:
    """Refuse options of the closed loop of red teaming in the open one.

    Raises:
        UsageError: If one of them was given.
    """
    refuse_idle("with --open-loop", "nearest", "nearest_label", "rarity", "broadenings")


def things_encoder(name: str) -> "Encoder | None":
    """Return the encoder that `things_option` names, with a cache; `None` for `none`."""
    from oodscen import make_encoder

    return None if name.casefold() == "none" else make_encoder(name, cache=True)


out_option = click.option(
    "-o",
    "--out",
    type=OutputName(),
    help="File to write.  [default: standard output]",
)
extras_options = grouped_options(
    click.option(
        "--traces",
        is_flag=True,
        help="Write traces/SCENE.parquet: ground truth of every step and action.",
    ),
    click.option(
        "--annotations", is_flag=True, help="Write boxes, classes, ids and depth of every frame."
    ),
    click.option(
        "--video",
        is_flag=False,
        flag_value="both",
        type=click.Choice(("ego", "bird", "both")),
        help="Write videos/SCENE.mp4 from the ego's camera, from above, or both (the default without a value).",
    ),
)
red_options = grouped_options(
    click.option(
        "--open-loop",
        is_flag=True,
        help="Use the paper's open loop: no feedback to the model, no refusals, no splits.",
    ),
    click.option(
        "--red-patience",
        type=click.IntRange(min=1),
        help="Stop red teaming after this many consecutive rounds without a new kind.",
    ),
    click.option(
        "--red-coverage",
        type=SHARE,
        help="Stop red teaming once the Good-Turing coverage exceeds this share.",
    ),
    click.option(
        "--in-flight",
        type=click.IntRange(1, MOST_IN_FLIGHT),
        help="Concurrent proposals; each sees the tree as it was this many rounds earlier.  [default: 1]",
    ),
    click.option(
        "--nearest",
        type=FiniteRange(-1.0, 1.01),
        help=f"Reject proposals at least this similar to an earlier one.  [default: {NEAREST_TEXT}]",
    ),
    click.option(
        "--nearest-label",
        type=FiniteRange(-1.0, 1.01),
        help=f"Reject proposals at least this similar to the label of a leaf.  [default: {NEAREST_LABEL}]",
    ),
    click.option(
        "--rarity",
        nargs=2,
        type=FiniteRange(0, min_open=True),
        metavar="LO HI",
        help="Refuse kinds met more often than once in LO km, or more rarely than once in HI km.",
    ),
    click.option(
        "--broadenings",
        type=click.IntRange(min=0),
        help=f"Number of times a leaf is broadened before it is split.  [default: {BROADENINGS}]",
    ),
)
picture_options = grouped_options(
    click.option(
        "--width",
        type=click.IntRange(64, 4096),
        help=f"Columns of the frames, in pixels.  [default: {Camera.width}]",
    ),
    click.option(
        "--height",
        type=click.IntRange(48, 4096),
        help=f"Rows of the frames, in pixels.  [default: {Camera.height}]",
    ),
)
style_option = click.option(
    "--style",
    type=click.Choice(("natural", "paper", "terse", "verbose", "first-person")),
    help="Style of the texts.  [default: natural]",
)


def _rear_view_option(default: str) -> Callable[[Command], Command]:
    return click.option(
        "--rear-view/--no-rear-view",
        default=None,
        help=f"Show the view from the rear window at the decision as well.  [default: {default}]",
    )


rear_view_option = _rear_view_option("--no-rear-view")
study_rear_view_option = _rear_view_option("the study's, or --no-rear-view")
judging_options = grouped_options(
    click.option(
        "--protocol",
        type=click.Choice(("ours", "paper")),
        default="ours",
        show_default=True,
        help="Judging protocol; `paper` is the paper's own: whole traces, collisions only, no ordinary drives.",
    ),
    click.option(
        "--chain/--no-chain",
        default=None,
        help="Show a model its own descriptions of the frames before every question.  [default: the study's, or --no-chain]",
    ),
    study_rear_view_option,
    click.option(
        "--without-pictures",
        is_flag=True,
        help="Also ask the same questions with the pictures withheld; adds a row MODEL without pictures.",
    ),
    click.option(
        "--ordinary",
        type=click.IntRange(1, 2),
        help="Ordinary drives asked about per scene: its twin or its demand, or both.  [default: the study's, or 1]",
    ),
    click.option("--judge", help="Model that judges the open answers."),
)
json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON.")
require_option = click.option(
    "--require",
    "required",
    metavar="BARS",
    help='Grade the models, e.g. "safe>=0.9,needless<=0.05,notice>=0.8".',
)
LIMITS = (
    "max_requests", "max_tokens", "max_cost", "max_seconds", "prices", "concurrency", "timeout",
    "patience",
)  # fmt: skip
"""Parameters of `limit_options`."""
limit_options = grouped_options(
    click.option(
        "--max-requests", type=click.IntRange(min=0), help="Maximum number of HTTP requests."
    ),
    click.option(
        "--max-tokens",
        type=click.IntRange(min=0),
        help="Maximum number of tokens, input and output together.",
    ),
    click.option("--max-cost", type=FiniteRange(min=0), help="Maximum cost in USD."),
    click.option(
        "--max-seconds", type=FiniteRange(min=0), help="Send no request after this many seconds."
    ),
    click.option(
        "--price",
        "prices",
        multiple=True,
        metavar="MODEL=IN,OUT",
        help="Price of a model in USD per million input and output tokens; repeatable.",
    ),
    click.option(
        "--concurrency",
        default=8,
        show_default=True,
        type=click.IntRange(1, 1_000),
        help="Maximum number of concurrent requests per server; lowered while the server reports too many.",
    ),
    click.option(
        "--timeout",
        default=TIMEOUT_S,
        show_default=True,
        type=FiniteRange(0, LONGEST_S, min_open=True),
        help="Seconds until an answer must be complete; after one retry the item fails.",
    ),
    click.option(
        "--patience",
        default=PATIENCE_S,
        show_default=True,
        type=FiniteRange(1, LONGEST_S),
        help="Seconds without any response after which a server is given up.",
    ),
)


def limits_from(choices: dict[str, Any]) -> "Limits":
    """Remove the options of `limit_options` from a command's arguments and return them as `Limits`.

    Raises:
        UsageError: When a price is malformed.
    """
    from oodscen.llm._remote.limits import Limits

    return Limits(
        requests=choices.pop("max_requests"),
        tokens=choices.pop("max_tokens"),
        cost_usd=choices.pop("max_cost"),
        seconds=choices.pop("max_seconds"),
        prices=_prices(choices.pop("prices")),
        concurrency=choices.pop("concurrency"),
        patience_s=choices.pop("patience"),
        timeout_s=choices.pop("timeout"),
    )


def _prices(texts: Sequence[str]) -> "dict[str, Price]":
    prices: dict[str, Price] = {}
    for model, price in map(_price, texts):
        if prices.setdefault(model, price) != price:
            raise UsageError(f"--price gives {model!r} two prices; keep one")
    return prices


def _price(text: str) -> "tuple[str, Price]":
    from oodscen.llm._remote.budget import Price

    model, _, values = text.rpartition("=")
    try:
        input_usd, output_usd = map(float, values.split(","))
    except ValueError:
        model = ""
    if not model:
        raise UsageError(
            f"{text!r} is not a price; write MODEL=IN,OUT in USD per million tokens, e.g. gpt-4o=2.5,10"
        )
    return model, check_price(model, Price(input_usd, output_usd))
