"""The quiz: one self-contained page that puts a study's questions to a person."""

import base64
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from oodscen._files import read_bytes, replace
from oodscen._seeding import stream
from oodscen.data._base import canonical_json
from oodscen.data._episode import Episode, in_order
from oodscen.data._messages import Image
from oodscen.data._pairing import is_ordinary, scene_of
from oodscen.data._scenario import Scenario
from oodscen.errors import DataError, Issue
from oodscen.judging._kinds import Kinds
from oodscen.judging._people import token
from oodscen.judging._selection import chosen
from oodscen.prompts._base import Prompt
from oodscen.prompts._judging.choose_action import ChooseAction
from oodscen.prompts._judging.choose_aspect import ChooseAspect
from oodscen.prompts._judging.name_aspect import NameAspect
from oodscen.report._render import environment
from oodscen.stages._evaluate import OPTIONS, Shown, aspect_options
from oodscen.study._study import Study

SCENES = 20
"""Scenes of a quiz, unless told otherwise; each comes with its ordinary drives."""


def write_quiz(study: Study, out: Path | None = None, *, scenes: int = SCENES) -> Path:
    """Write the quiz of a study, and return the file's path.

    The page holds the pictures and the questions as models get them, in the same order, and neither an answer
    nor an id that tells one. It needs no network.

    Args:
        study: The study.
        out: The file; `quiz.html` in the study's folder by default.
        scenes: Maximum number of scenes, drawn by the study's seed so that all paths have their share.

    Raises:
        DataError: If no episode of the study has frames.
    """
    target = out or study.folder / "quiz.html"
    page = environment().get_template("quiz.html.j2").render(payload=_payload(study, scenes))
    replace(target, page.encode("utf-8"))
    return target


def _payload(study: Study, scenes: int) -> str:
    """Return the data of the page as JSON that can stand in a script element."""
    seed = study.config.seed
    by_id = {scenario.id: scenario for scenario in study.scenarios}
    maps = {scene.id: scene.map for scene in study.scenes}
    kinds = Kinds.of(study.scenarios, maps, seed=seed)
    items = []
    for episode in _drawn(study, by_id, scenes):
        scenario = by_id.get(scene_of(episode.scene_id))
        place = maps.get(scene_of(episode.scene_id), "")
        options = aspect_options(
            kinds.offered(scenario.leaf if scenario else "", place),
            seed=seed,
            item=episode.scene_id,
        )
        items.append(_item(study, episode, [[one.id, one.label] for one in options]))
    if not items:
        raise DataError("study", [Issue("", "no episode has frames")], source=str(study.folder))
    actions = [[option.id, option.description] for option in OPTIONS]
    payload = {"study": study.folder.resolve().name, "actions": actions, "items": items}
    return canonical_json(payload).replace("<", "\\u003c")


def _item(study: Study, episode: Episode, options: list[list[str]]) -> dict[str, Any]:
    frames = {
        moment: Image.from_file(study.store.inside(file), file)
        for moment, file in episode.frames.items()
    }
    shown = Shown.of(episode, frames)
    told: dict[str, Any] = {"frames": shown.images, "facts": shown.facts}
    named = _paragraphs(NameAspect(**told))
    listed = _paragraphs(ChooseAspect(**told, labels=("-",)))
    acted = _paragraphs(ChooseAction(**told, options=OPTIONS))
    return {
        "item": token(episode),
        "frames": [_data_url(study.store.inside(episode.frames[one])) for one in in_order(frames)],
        "times": [f"{time:.1f} s" for time in shown.facts.times_s],
        "facts": named[0],
        "questions": [named[1], listed[1], acted[1]],
        "options": options,
    }


def _paragraphs(prompt: Prompt[Any]) -> list[str]:
    """Return the paragraphs of a question, each in one line."""
    return [" ".join(part.split()) for part in prompt.question().split("\n\n")]


def _data_url(path: Path) -> str:
    data = read_bytes(path)
    kind = "png" if data.startswith(b"\x89PNG") else "jpeg"
    return f"data:image/{kind};base64,{base64.b64encode(data).decode()}"


def _drawn(study: Study, by_id: dict[str, Scenario], scenes: int) -> Sequence[Episode]:
    """Return the episodes of the quiz, shuffled."""
    config = study.config
    unseen = {one.scene_id for one in study.episodes if one.is_below_floor}
    shown = [
        one
        for one in chosen(study.episodes, count=config.ordinary, seed=config.seed)
        if one.status == "ok" and one.frames and scene_of(one.scene_id) not in unseen
    ]
    paths: dict[str, list[str]] = {}
    for name in sorted(one.scene_id for one in shown if not is_ordinary(one.scene_id)):
        paths.setdefault(by_id[name].leaf if name in by_id else "", []).append(name)
    draw = stream(config.seed, "quiz")
    ranked = [
        (rank, float(draw.random()), paths[leaf][int(index)])
        for leaf in sorted(paths)
        for rank, index in enumerate(draw.permutation(len(paths[leaf])))
    ]
    taken = {name for _, _, name in sorted(ranked)[:scenes]}
    found = [one for one in shown if scene_of(one.scene_id) in taken]
    return [found[int(index)] for index in draw.permutation(len(found))]
