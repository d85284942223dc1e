"""The augmenter, which turns a text into a complete scene for a simulator (paper, section III-B)."""

from collections.abc import Callable, Sequence
from functools import cached_property

from oodscen._arguments import checked, instance_of
from oodscen._display import Brief
from oodscen._numbers import whole_number
from oodscen._progress import Progress, reporting
from oodscen._words.text import one_line
from oodscen.claims._checking import check_claims, mismatches
from oodscen.claims._faithfulness import extract_claims
from oodscen.claims._matching import Likeness, likeness_of
from oodscen.claims._roads import fitting_roads, road_claims
from oodscen.claims._things import may_be
from oodscen.data._catalogue import Catalogue
from oodscen.data._claim import Claim, Mismatch
from oodscen.data._designs.motion import Motion
from oodscen.data._designs.prop import Prop
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene, Trigger
from oodscen.driving._sight.placement import check_scene
from oodscen.errors import AnswerError, DataError, Issue
from oodscen.llm._ask import ATTEMPTS, ask
from oodscen.prompts._digest import CatalogueDigest
from oodscen.prompts._fitting import fitted
from oodscen.prompts._scenario.stage_scene import SceneDraft, StageScene
from oodscen.protocols import LLM, Encoder
from oodscen.stages._hazard_words import visible_of


class Augmenter(Brief):
    """Asks the augmenter-LLM to stage texts; every scene it returns is valid and runs.

    Before staging, the claims of a text are extracted from the text alone. The model is told them, and says
    which actor shows which thing, or that the simulator cannot show the text. Every scene is checked against
    the claims, and what it contradicts is fed back.

    Args:
        llm: The augmenter-LLM.
        catalogue: The assets and abilities of the simulator.
        made: Things made to order, which scenes may use beside the catalogue's.
        motions: Motions made to order, likewise.
        check: Returns the faults of a scene, which are fed back to the model. The default checks the
            catalogue's vocabulary, places on the road, overlap and reachability.
        attempts: Maximum number of calls per scene.
        claims: Require scenes to satisfy the claims of their texts.
        reader: Model that extracts the claims; the augmenter-LLM if left out.
        context: Context window of the model in tokens, if the whole catalogue is too long for it.
        encoder: Compares the things of a text with the actors that are said to show them; without one whose
            cosines follow meaning, a noun by which no asset is known may be any asset.
    """

    _repr_fields = ("llm", "catalogue", "claims", "attempts")

    @checked
    def __init__(
        self,
        llm: LLM,
        catalogue: Catalogue,
        *,
        check: Callable[[Scene, Catalogue], Sequence[Issue]] = check_scene,
        attempts: int = ATTEMPTS,
        claims: bool = True,
        reader: LLM | None = None,
        context: int | None = None,
        encoder: Encoder | None = None,
        made: Sequence[Prop] = (),
        motions: Sequence[Motion] = (),
    ) -> None:
        instance_of("catalogue", catalogue, Catalogue)
        self.llm = llm
        self.catalogue = catalogue.with_made(made, motions)
        self.made = tuple(made)
        self.motions = tuple(motions)
        self.digest = CatalogueDigest.of(self.catalogue)
        self.check = check
        self.attempts = whole_number("attempts", attempts, 1)
        self.claims = claims
        self.reader = reader or llm
        self.context = None if context is None else whole_number("context", context, 1)
        self.encoder = encoder

    @cached_property
    def _likeness(self) -> Likeness | None:
        return likeness_of(self.encoder, self.catalogue)

    @checked
    def read(self, scenario: Scenario | str) -> tuple[Claim, ...]:
        """Return the claims of a scenario or a text, from its words alone, or none if claims are switched off.

        Raises:
            AnswerError: When the model gives no valid claims; the error lists the faults.
            LLMError: When the model cannot be reached.
        """
        if not self.claims:
            return ()
        text = scenario if isinstance(scenario, str) else scenario.text
        return extract_claims(self.reader, text, attempts=self.attempts)

    @checked
    def run(
        self,
        scenario: Scenario,
        claims: Sequence[Claim] | None = None,
        *,
        progress: Progress | bool | None = None,
    ) -> Scene:
        """Return the scene of one text, with the scenario's id.

        Args:
            scenario: The scenario with the text.
            claims: Claims of the text, if already extracted.
            progress: True for a progress bar, or a callable; it counts reading the claims and staging.

        Raises:
            AnswerError: When the model gives no scene that runs and satisfies the claims, or says that there is
                none; the error lists the faults and every contradicted claim, or the reason.
            LLMError: When the model cannot be reached.
        """
        instance_of("scenario", scenario, Scenario)
        with reporting(progress) as report_progress:
            report_progress("augment", 0, 2)
            claims = self.read(scenario) if claims is None else tuple(claims)
            report_progress("augment", 1, 2)
            scene = self._stage(scenario, claims)
            report_progress("augment", 2, 2)
        return scene

    def _stage(self, scenario: Scenario, claims: tuple[Claim, ...]) -> Scene:
        prompt = StageScene(
            text=scenario.text,
            path=scenario.path,
            claims=claims,
            roads=self.roads(claims),
            catalogue=self.digest,
        )
        draft = ask(
            self.llm,
            fitted(prompt, self.context),
            check=lambda draft: self.faults(scenario, claims, draft),
            attempts=self.attempts,
        )
        if draft.cannot_show:
            fault = Issue("cannot_show", one_line(draft.cannot_show))
            raise AnswerError(self.llm.name, prompt.purpose, [fault], draft.model_dump_json(), 1)
        return scene_of_draft(scenario, draft, self.catalogue, self.made, self.motions)

    @checked
    def roads(self, claims: Sequence[Claim]) -> tuple[str, ...]:
        """Return the maps that satisfy all claims about the road; empty without such claims.

        Raises:
            AnswerError: When no map satisfies them.
        """
        about_roads = road_claims(claims)
        if not about_roads:
            return ()
        roads = fitting_roads(about_roads, self.catalogue.maps)
        if not roads:
            statements = "; ".join(map(str, about_roads))
            fault = Issue(
                "cannot_show",
                f"the simulator has no road with all of these properties: {statements}",
            )
            raise AnswerError(self.llm.name, StageScene.purpose, [fault], "", 0)
        return roads

    @checked
    def faults(
        self, scenario: Scenario, claims: Sequence[Claim], draft: SceneDraft
    ) -> Sequence[Issue]:
        """Return the faults of a draft, each with its cause; none if it says that the text cannot be shown."""
        if draft.cannot_show:
            return []
        try:
            scene = scene_of_draft(scenario, draft, self.catalogue, self.made, self.motions)
        except DataError as error:
            return error.issues
        faults = self.check(scene, self.catalogue)
        if faults or not claims:
            return faults
        checks = check_claims(claims, scene, self.catalogue, likeness=self._likeness)
        return _issues_by_cause(mismatches(checks), scene)


def _issues_by_cause(contradicted: Sequence[Mismatch], scene: Scene) -> list[Issue]:
    """Return one issue per cause: claims about one thing that fail for the same reason are one."""
    causes: dict[tuple[str, str, str], list[Mismatch]] = {}
    for mismatch in contradicted:
        causes.setdefault((mismatch.path, mismatch.claim.subject, mismatch.found), []).append(
            mismatch
        )
    issues: list[Issue] = []
    honest = " (if no honest scene can show it, say so in `cannot_show`)"
    for (path, subject, found), group in causes.items():
        statements = "; ".join(
            str(mismatch.claim).removeprefix(f"{subject}: ") for mismatch in group
        )
        about = f"{subject}: " if subject else ""
        if subject and path == "actors" and subject not in scene.stands_for:
            hint = "; if one of the actors shows it, say which in `stands_for`"
        else:
            hint, honest = honest, ""
        issues.append(Issue(path, f"the text says {about}{statements}, but {found}{hint}"))
    return issues


def scene_of_draft(
    scenario: Scenario,
    draft: SceneDraft,
    catalogue: Catalogue,
    made: Sequence[Prop] = (),
    motions: Sequence[Motion] = (),
) -> Scene:
    """Return the scene; a decision without an actor refers to the first actor of the hazard.

    The scene carries the designs of those things and motions made to order that it shows.
    """
    ordinary = [actor for actor in draft.hazard.actors.values() if actor is not None]
    assets = {actor.asset for actor in (*draft.actors, *ordinary)}
    behaviours = {actor.behaviour.name for actor in (*draft.actors, *ordinary)}
    scene = Scene(
        id=scenario.id,
        scenario_id=scenario.id,
        map=draft.map,
        ego=draft.ego,
        weather=draft.weather,
        actors=tuple(draft.actors),
        hazard=draft.hazard,
        decision=_decision_of(draft),
        horizon_s=draft.horizon_s,
        stands_for={
            thing: tuple(names)
            for thing, names in draft.stands_for.items()
            if not _noun_suffices(thing, names, draft, catalogue)
        },
        made=tuple(prop for prop in made if prop.id in assets),
        motions=tuple(motion for motion in motions if motion.id in behaviours),
        map_state=draft.map_state,
    )
    return scene.model_copy(update={"visible": visible_of(scene, catalogue)})


def _decision_of(draft: SceneDraft) -> Trigger:
    """Return the decision; one that needs an actor and names none refers to the hazard's first."""
    decision = draft.decision
    if decision.kind == "time" or decision.actor is not None:
        return decision
    first = next(iter(draft.hazard.actors), None)
    return decision.model_copy(update={"actor": first})


def _noun_suffices(
    thing: str, names: Sequence[str], draft: SceneDraft, catalogue: Catalogue
) -> bool:
    """Return whether the noun of a thing alone leads to the actors that show it."""
    by_id = {asset.id: asset for asset in catalogue.assets}
    by_actor = {actor.id: by_id.get(actor.asset) for actor in draft.actors}
    assets = [by_actor.get(name) for name in names]
    return all(asset is not None and may_be(thing, asset) for asset in assets)
