"""Red teaming: a red-LLM imagines scenarios, and the tree-LLM makes the tree cover them."""

from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, ClassVar, NamedTuple

from oodscen._arguments import checked
from oodscen._display import Brief
from oodscen._parallel.threads import cancelling
from oodscen._progress import Progress, reporting
from oodscen._words.text import one_line
from oodscen.data._catalogue import Catalogue
from oodscen.errors import AnswerError, DataError, Issue, LLMError
from oodscen.llm._ask import ask, speaker
from oodscen.metrics._rarity.estimates import estimated_km
from oodscen.prompts._digest import CatalogueDigest
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from oodscen.prompts._tree.place_scenario import PlacedScenario, PlaceScenario
from oodscen.protocols import LLM, Completion, Encoder, Request
from oodscen.stages._failures import refuse_if_all_failed
from oodscen.stages._options import RedTeamOptions, with_changes
from oodscen.stages._redteam.changes import edits_of, misfits, resolve_decision, runners_up
from oodscen.stages._redteam.excerpt import excerpt, list_leaves
from oodscen.stages._redteam.families import corner, thin
from oodscen.stages._redteam.naming import Names
from oodscen.stages._redteam.near_duplicates import NoveltyFilter
from oodscen.stages._redteam.rarity import WantedRarity
from oodscen.stages._redteam.rounds import Round, RunnerUp
from oodscen.stages._redteam.saturation import Saturation, saturation
from oodscen.stages._redteam.stopping import Stop, Stopping
from oodscen.tree._scenario_tree import ScenarioTree

__all__ = ["RedTeamer", "Round", "RunnerUp"]


class RedTeamer(Brief):
    """Grows a diverse tree out of an initial one (paper, section III-A, red teaming).

    Closed loop, the default: the red-LLM sees what the tree covers, where it is thin and which proposals were
    rejected. A proposal that the `encoder`, if given, finds too similar to what exists is refused before the
    tree-LLM is asked, and a leaf that was broadened often is split. Open loop is the paper's
    procedure: nothing is shown and nothing refused, and nodes are added or broadened.

    Args:
        llm: The tree-LLM.
        red_llm: The red-LLM; the same model if left out.
        encoder: Compares proposals with what exists, e.g. `make_encoder("minilm")`, as in a study and on the
            command line. Without one, only literal repetitions are refused. Not used in the open loop.
        catalogue: The simulator that will show the scenarios, which the red-LLM is told of in the closed loop.
        options: All other options; the defaults if left out.
        cancel: Called when waiting for answers is interrupted, so that pending calls end soon.
        **changes: Single options, e.g. `iterations=20`, instead of those in `options`.

    Raises:
        UsageError: For an unknown option, or a value that is not allowed.
    """

    Options: ClassVar[type[RedTeamOptions]] = RedTeamOptions
    """The options as one frozen value."""
    _repr_fields = ("llm", "red_llm", "encoder", "options")

    @checked
    def __init__(
        self,
        llm: LLM,
        red_llm: LLM | None = None,
        *,
        encoder: Encoder | None = None,
        catalogue: Catalogue | None = None,
        options: RedTeamOptions | None = None,
        cancel: Callable[[], None] | None = None,
        **changes: Any,
    ) -> None:
        self.llm = llm
        self.red_llm = red_llm or llm
        self.options = with_changes(RedTeamOptions, options, changes)
        self.encoder = encoder if self.options.closed_loop else None
        self.catalogue = CatalogueDigest.of(catalogue) if catalogue else None
        self.cancel = cancel

    @checked
    def run(self, tree: ScenarioTree, *, progress: Progress | bool | None = None) -> ScenarioTree:
        """Return the tree after all rounds; each edit holds its round, text and reason.

        A round that fails leaves the tree unchanged; `rounds` tells why.

        Args:
            tree: The initial tree.
            progress: True for a progress bar, or a callable; it counts the rounds.

        Raises:
            LLMError: When every round fails.
        """
        played: list[Round] = []
        with reporting(progress) as report_progress:
            total = self.options.iterations
            report_progress("redteam", 0, total)
            for item in self.rounds(tree):
                played.append(item)
                report_progress("redteam", len(played), total)
            if len(played) < total:
                report_progress("redteam", len(played), len(played))
        refuse_if_all_failed(played, "every round failed", self.red_llm.name)
        return tree.apply(*(edit for item in played for edit in item.edits))

    @checked
    def rounds(self, tree: ScenarioTree, done: Iterable[Round] = ()) -> Iterator[Round]:
        """Play the rounds one by one, until a stopping rule holds.

        A round that fails, or whose answer stays invalid or does not fit the tree, is yielded with its error
        and leaves the tree unchanged.

        Args:
            tree: The tree before the first round.
            done: Earlier rounds to continue from.
        """
        game = _Session(self, tree)
        for item in done:
            game.add(item)
        in_flight = self.options.in_flight
        threads = in_flight if self.options.threads is None else self.options.threads
        if threads <= 1 or in_flight <= 1:
            while game.progress.stop is None:
                number = game.progress.round + 1
                attempts = game.progress.attempts()
                yield game.play(self._imagine(game.questions[number], number, attempts))
            return
        with (
            ThreadPoolExecutor(min(threads, in_flight)) as pool,
            cancelling(self.cancel),
        ):
            flying: dict[int, Future[_Proposal]] = {}
            while game.progress.stop is None:
                first = game.progress.round + 1
                for number in range(first, first + in_flight):
                    is_due = number == first or game.progress.is_certain(number)
                    if number not in flying and is_due:
                        question, attempts = game.questions[number], game.progress.attempts()
                        flying[number] = pool.submit(self._imagine, question, number, attempts)
                yield game.play(flying.pop(first).result())

    @checked
    def stopped_by(self, rounds: Iterable[Round]) -> Stop | None:
        """Return the rule that ends the red teaming after these rounds, or `None` if it goes on."""
        progress = Stopping(self.options)
        for item in rounds:
            progress.add(item)
        return progress.stop

    @staticmethod
    def saturation(rounds: Iterable[Round], *, patience: int = 15) -> Saturation:
        """Estimate from the log of a red team how much it has left to find.

        Args:
            rounds: All rounds in order, from the first.
            patience: Number of rounds without a new kind that count as dry, and number of recent rounds.
        """
        return saturation(rounds, patience=patience)

    def _imagine(self, question: ImagineScenario, number: int, attempts: int) -> "_Proposal":
        counted = _CountingLLM(self.red_llm)
        try:
            answer = ask(counted, question, sample=number, attempts=attempts)
        except (LLMError, DataError) as error:
            return _Proposal("", None, counted.calls, error)
        return _Proposal(one_line(answer.text), answer.once_in_km, counted.calls, None)


class _Proposal(NamedTuple):
    """A proposal of the red-LLM, or the error instead of it."""

    text: str
    once_in_km: float | None
    calls: int
    error: LLMError | DataError | None


class _CountingLLM:
    """Counts the model calls of one round."""

    def __init__(self, llm: LLM, calls: int = 0) -> None:
        self.name = llm.name
        self.calls = calls
        self._llm = llm

    def complete(self, request: Request) -> Completion:
        self.calls += 1
        return self._llm.complete(request)


class _Session:
    """The rounds so far, as a function of the initial tree and the log."""

    def __init__(self, teamer: RedTeamer, tree: ScenarioTree) -> None:
        self.teamer = teamer
        self.options = teamer.options
        self.tree = tree
        self.progress = Stopping(self.options)
        self.rarity = WantedRarity(self.options.rarity)
        self.novelty = NoveltyFilter(
            tree,
            teamer.encoder,
            text=self.options.nearest,
            label=self.options.nearest_label,
            shown=self.options.shown,
        )
        self.questions: dict[int, ImagineScenario] = {}
        """Questions of the next rounds, made as soon as the tree that they show is known."""
        self._rounds_before = max(
            (edit.round for edit in tree.edits if edit.round and not edit.origin), default=0
        )
        """Rounds in the log of the tree itself, after which those of its further edits count on."""
        self._broadened = Counter(edit.node for edit in tree.edits if edit.op == "broaden")
        self._rejected: deque[str] = deque(maxlen=5)
        """The last rejected proposals, which the red-LLM sees."""
        for number in range(1, self.options.in_flight + 1):
            self.questions[number] = self._question(number)

    def play(self, proposal: _Proposal) -> Round:
        item = self._decide(self.progress.round + 1, proposal)
        self.add(item)
        return item

    def add(self, item: Round) -> None:
        """Update tree, progress and novelty with a round."""
        self.tree = self.tree.apply(*item.edits)
        self.progress.add(item)
        if self.options.closed_loop:
            self.novelty.learn(item, self.tree)
            self.rarity.add(item)
            self._broadened.update(edit.node for edit in item.edits if edit.op == "broaden")
            if item.text and not any(edit.op in ("add", "broaden") for edit in item.edits):
                self._rejected.append(item.text)
        self.questions.pop(item.round, None)
        ahead = item.round + self.options.in_flight
        self.questions[ahead] = self._question(ahead)

    def _question(self, number: int) -> ImagineScenario:
        if not self.options.closed_loop:
            return ImagineScenario(shown=self.options.shown)
        covered, unlisted = list_leaves(self.tree, tokens=self.options.tokens, turn=number - 1)
        family = corner(self.tree, number, of=self.options.in_flight)
        return ImagineScenario(
            shown=self.options.shown,
            catalogue=self.teamer.catalogue,
            covered=covered,
            unlisted=unlisted,
            thin=() if family else thin(self.tree, turn=number - 1),
            refused=tuple(self._rejected),
            least_km=self.rarity.wanted[0],
            most_km=self.rarity.wanted[1],
            corner=family,
        )

    def _decide(self, number: int, proposal: _Proposal) -> Round:
        closed = self.options.closed_loop
        fields: dict[str, Any] = {
            "round": number,
            "text": proposal.text,
            "once_in_km": proposal.once_in_km,
            "nodes": len(self.tree),
            "calls": proposal.calls,
            "seen": max(number - self.options.in_flight, 0) if closed else 0,
        }
        if proposal.error is not None:
            return Round(**fields | _failure(proposal.error))
        if closed:
            closest = self.novelty.closest(proposal.text)
            fields |= {
                "similarity": closest.similarity,
                "nearest": closest.node,
                "nearest_by": closest.by,
            }
            if closest.is_too_near:
                origin = "the leaf" if closest.by == "label" else "the earlier proposal"
                reason = f"{closest.similarity:.2f} near to {origin} {closest.words!r}"
                return Round(**fields, decision="duplicate", reason=reason, kind=closest.node)
            fields |= self._rarity_of(proposal)
            if reason := self.rarity.fault(fields["once_in_km"]):
                return Round(**fields, decision="implausible", reason=reason)
        return Round(**fields | self._place(number, proposal))

    def _rarity_of(self, proposal: _Proposal) -> dict[str, Any]:
        """Return the red-LLM's own figure, or else the offline estimate."""
        if proposal.once_in_km is not None:
            return {"once_in_km": proposal.once_in_km, "once_in_km_by": "model"}
        km = estimated_km(self.teamer.encoder, proposal.text)
        return {"once_in_km": km, "once_in_km_by": None if km is None else "head"}

    def _place(self, number: int, proposal: _Proposal) -> dict[str, Any]:
        """Ask where the proposal belongs, and return the round's fields about the answer."""
        teamer, tree = self.teamer, self.tree
        counted = _CountingLLM(teamer.llm, proposal.calls)
        attempts = self.progress.attempts(proposal.calls)
        try:
            question, names = self._placing_question(proposal.text)
            placed = names.in_tree(
                ask(
                    counted,
                    question,
                    sample=number,
                    check=lambda answer: _misfits(question, tree, answer, names),
                    attempts=attempts,
                )
            )
            if question.procedure == "paper":
                placed = placed.model_copy(update={"members": [], "also": []})
            edits, kind = edits_of(
                tree,
                placed,
                splits_lists=self.options.closed_loop,
                stage="redteam",
                round=self._rounds_before + number,
                reason=placed.reasoning,
                source=proposal.text,
                model=speaker(teamer.llm),
                prompt=question.citation(),
            )
            after = tree.apply(*edits)
        except (LLMError, DataError) as error:
            return {"calls": counted.calls, **_failure(error)}
        return {
            "calls": counted.calls,
            "decision": resolve_decision(placed, edits),
            "reason": placed.reasoning,
            "edits": edits,
            "nodes": len(after),
            "kind": kind,
            "runners_up": runners_up(after, placed),
        }

    def _placing_question(self, text: str) -> tuple[PlaceScenario, Names]:
        """Return the question about the whole tree, or about the part of a large one that matters for a text.

        Ids in the question follow the current labels in full; the names translate those of the answer.
        """
        tree, closed = self.tree, self.options.closed_loop
        part = excerpt(
            tree, lambda: self.novelty.rank_leaves(text, tree), tokens=self.options.tokens
        )
        shown = {node.id for node in part.nodes}
        full = [
            name
            for name in shown
            if self._broadened[name] >= self.options.broadenings and not tree.children[name]
        ]
        question = PlaceScenario(
            text=text,
            nodes=part.nodes,
            hidden=part.hidden,
            full=tuple(sorted(full)) if closed else (),
            procedure="closed" if closed else "paper",
        )
        names = Names.of(tree, shown & self._broadened.keys())
        return names.in_question(question), names


def _misfits(
    question: PlaceScenario, tree: ScenarioTree, answer: PlacedScenario, names: Names
) -> list[Issue]:
    """Return the faults that only the whole tree reveals, if the question's own check finds none."""
    if question.check(answer):
        return []
    answer = names.in_tree(answer)
    if question.procedure == "paper":
        answer = answer.model_copy(update={"members": []})
    return misfits(tree, answer)


def _failure(error: LLMError | DataError) -> dict[str, Any]:
    is_malformed = isinstance(error, (AnswerError, DataError))
    return {
        "status": "failed",
        "error": str(error),
        "retryable": getattr(error, "retryable", False),
        "decision": "malformed" if is_malformed else None,
    }
