"""The hooks of a session that names a study: scenes as parameters, reports, grades and the baseline."""

import os
import re
from collections.abc import Generator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from oodscen._io.files import check_name
from oodscen._io.study_files import refuse_inside
from oodscen._words.text import printable
from oodscen.errors import OodscenError, UsageError
from oodscen.pytest_plugin._baseline import Change, KnownOutcomes, KnownTest, Outcome, update
from oodscen.pytest_plugin._hooks import path_setting, setting
from oodscen.pytest_plugin._subtests import Subtests

if TYPE_CHECKING:
    from oodscen.data._catalogue import Catalogue
    from oodscen.data._drive_result import DriveResult
    from oodscen.data._scene import Scene
    from oodscen.judging._leaderboard.requirements import Bar, RequirementResult
    from oodscen.pytest_plugin._driving import Drive
    from oodscen.pytest_plugin._scenes import Scenes
    from oodscen.study._study import Study

PARAMETER = "oodscen_scene"
"""Name of the parameter behind the fixture `scene`, which a test's own `scene` hides."""
DRIVE = pytest.StashKey["Drive"]()
"""The fixture `drive` of a test."""
SUBTESTS = pytest.StashKey[Subtests]()
"""The subtests of a test."""
_PHASES = ("setup", "call", "teardown")
"""Phases of a test; pytest-xdist reports one during which a process died in a phase of its own, "???"."""


class DrivingSession:
    """The hooks of a session that names a study.

    Every process of a parallel session has one. The main process collects what the reports carry.

    Args:
        config: The session's configuration.
        folder: The folder of the study.

    Raises:
        pytest.UsageError: If the requirement or the baseline is malformed.
    """

    def __init__(self, config: pytest.Config, folder: Path) -> None:
        self._config, self._folder = config, folder
        self._mode: str = config.getoption("oodscen_baseline_mode") or "compare"
        self._file = path_setting(config, "oodscen_baseline")
        """The file of the baseline, if one is named."""
        self._grades: list[RequirementResult] = []
        self._changes: dict[str, Change] = {}
        self._tests: dict[str, KnownTest] = {}
        """The outcomes of this session's tests, by their ids in the baseline."""
        self._drives: dict[str, DriveResult] = {}
        self._fault: str | None = None
        """The error that kept the baseline or the grades from being made."""
        self._is_whole = False
        """True once all tests have run."""
        self._is_cut_short = False
        """True once a process has died, or Ctrl-C, `pytest.exit` or the last failure that `-x` allows has come."""
        self._registered_marks: set[str] = set()
        try:
            self._bars = _parse_bars(setting(config, "oodscen_require"))
            self._per_path = _scenes_per_path(setting(config, "oodscen_per_path"))
            self._baseline = self._read_baseline()
        except OodscenError as error:
            raise pytest.UsageError(printable(str(error))) from None

    def _read_baseline(self) -> KnownOutcomes:
        """Return the known outcomes; none yet if they are to be written."""
        if self._file is None:
            if self._mode != "compare":
                raise UsageError(f"--oodscen-baseline-mode {self._mode} needs --oodscen-baseline")
            return KnownOutcomes(tests={})
        check_name(self._file)
        if self._mode != "compare" and not self._file.exists():
            return KnownOutcomes(tests={})
        if self._mode != "write":
            return KnownOutcomes.at(self._file)
        try:
            KnownOutcomes.at(self._file)
        except OodscenError as error:
            raise UsageError(f"{error}\nonly a baseline is overwritten") from None
        return KnownOutcomes(tests={})

    @cached_property
    def study(self) -> "Study":
        """The study."""
        from oodscen.study._study import Study

        return Study.open(self._folder)

    @cached_property
    def scenes(self) -> "Scenes":
        """The texts, plans and folder that the drives of the session share.

        Raises:
            UsageError: If a scene or its text has changed since it was run.
            DataError: If a table of the study is malformed.
        """
        from oodscen.pytest_plugin._scenes import Scenes
        from oodscen.study._stale import refuse_stale

        # Grades and safe actions are those of the scenes as they were run, as for `oodscen drive`.
        refuse_stale(self.study, self.study.episodes, self.study.scenes)
        return Scenes(self.study, self.study.config.seed, self._pictures())

    @property
    def _collects_only(self) -> bool:
        return bool(self._config.getoption("collectonly", False))

    @cached_property
    def simulator_name(self) -> str:
        """Name of the simulator to drive in."""
        return setting(self._config, "oodscen_simulator") or self.study.config.simulator

    def _pictures(self) -> Path | None:
        """Return the folder for pictures: as named, else beside the JUnit file.

        Raises:
            FolderTaken: If it is a study, or lies below one of its own files or folders.
        """
        folder = path_setting(self._config, "oodscen_pictures")
        junit = self._config.getoption("xmlpath", None)
        if folder is None and junit:  # Pytest expands `~` and variables of the environment in it.
            file = os.path.expanduser(os.path.expandvars(junit))
            folder = Path(self._config.invocation_params.dir, file).parent / "oodscen"
        if folder is not None:
            refuse_inside(folder)
        return folder

    @cached_property
    def parameters(self) -> list[Any]:
        """One parameter per scene, with its id and its marks."""
        scenes, catalogue = self.scenes, self._catalogue()
        return [
            pytest.param(
                scene,
                id=scene.id,
                marks=[self._mark(name) for name in scenes.marks(scene, catalogue)],
            )
            for scene in scenes.first_per_path(self._per_path)
        ]

    def _catalogue(self) -> "Catalogue | None":
        from oodscen._registry import make_catalogue

        try:
            return make_catalogue(self.simulator_name)
        except OodscenError:  # The tests that need the simulator say what is wrong with it.
            return None

    def _mark(self, name: str) -> pytest.MarkDecorator:
        if name not in self._registered_marks:
            self._registered_marks.add(name)
            kind, _, label = name.partition("_")
            self._config.addinivalue_line("markers", f"{name}: scenes with the {kind} {label}")
        mark: pytest.MarkDecorator = getattr(pytest.mark, name)
        return mark

    def register_marks(self) -> None:
        """Register the marks of the scenes, for `pytest --markers`.

        Raises:
            pytest.UsageError: If the study cannot be read.
        """
        try:
            _ = self.parameters
        except OodscenError as error:
            raise pytest.UsageError(printable(str(error))) from None

    def pytest_generate_tests(self, metafunc: pytest.Metafunc) -> None:
        """Make one test per scene of every test that uses one."""
        if PARAMETER in metafunc.fixturenames:
            try:
                parameters = self.parameters
            except OodscenError as error:
                raise pytest.Collector.CollectError(printable(str(error))) from None
            metafunc.parametrize(PARAMETER, parameters, indirect=True)

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_makereport(
        self, item: pytest.Item, call: pytest.CallInfo[None]
    ) -> Generator[None, pytest.TestReport, pytest.TestReport]:
        """Add what happened to the report of a test, and forgive a failure that is known or counted."""
        report = yield
        drive, subtests = item.stash.get(DRIVE, None), item.stash.get(SUBTESTS, Subtests())
        scene = drive.scene if drive else _scene_of(item)
        if scene is None or report.when == "teardown":
            return report
        if report.when == "setup" and report.passed:
            return report
        driven = [result.model_dump(mode="json") for result in drive.results] if drive else []
        if report.skipped:
            # Neither passed nor failed, for the baseline; what it drove counts for the stack nevertheless.
            vars(report)["oodscen"] = {"drives": driven}
            if driven:
                self._add_properties(item, report, scene, drive)
            return report
        outcome: Outcome = "failed" if report.failed or subtests.forgiven else "passed"
        known_test = KnownTest(outcome=outcome, scene=scene.digest())
        test = self._test_id(item)
        change = self._baseline.change(test, outcome, known_test.scene)
        if report.failed and drive is not None:
            self._add_sections(report, drive)
        self._add_properties(item, report, scene, drive, change)
        own_drives = subtests.own_drives(drive, call) if drive else []
        reason = subtests.all_forgiven if report.passed and subtests.is_over else None
        if report.failed:
            reason = self._forgiven(change, call, own_drives)
            subtests.forgiven.append(reason)
        if reason:
            report.outcome = "skipped"
            vars(report)["wasxfail"] = f"reason: {reason}"
        vars(report)["oodscen"] = {
            "test": test,
            "known": known_test.model_dump(),
            "change": change,
            "drives": driven,
        }
        return report

    def _add_sections(self, report: pytest.TestReport, drive: "Drive") -> None:
        """Add what the drives of a failed test show, with pictures of the last."""
        if not drive.drives:
            return
        drive.pictured()
        for driven in drive.drives:
            actions = self.scenes.safe_actions.get(driven.scene.id, ())
            report.sections.append(("oodscen", driven.report(actions)))

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Generator[None]:
        """Tell the reports of a test's subtests, which are made while it runs, from its own."""
        subtests = item.stash[SUBTESTS] = Subtests()
        try:
            yield
        finally:
            subtests.is_over = True

    def _test_id(self, item: pytest.Item) -> str:
        """Return the id of a test in the baseline: its path is relative to the file of the baseline.

        Pytest's own ids are relative to a root folder that depends on the command line.
        """
        if self._file is None:
            return item.nodeid
        path = Path(os.path.relpath(item.path, self._file.parent)).as_posix()
        test = f"{path}::{item.nodeid.partition('::')[2]}"
        # Names of files need not be UTF-8, the baseline must.
        return test.encode("utf-8", "backslashreplace").decode()

    def _add_properties(
        self,
        item: pytest.Item,
        report: pytest.TestReport,
        scene: "Scene",
        drive: "Drive | None",
        change: Change | None = None,
    ) -> None:
        """Add the properties of a test for the JUnit file; one that is skipped does not differ from the baseline."""
        from oodscen.pytest_plugin._properties import drive_properties, with_properties

        properties: list[tuple[str, object]] = [
            ("oodscen.scene", scene.id),
            ("oodscen.path", " > ".join(self.scenes.path(scene))),
        ]
        if self._file is not None and change is not None:
            properties.append(("oodscen.change", change))
        if drive is not None:
            properties += drive_properties(drive)
        # Reports of subtests before have left fewer of the same names.
        item.user_properties = with_properties(item.user_properties, properties)
        report.user_properties = list(item.user_properties)

    def _forgiven(
        self, change: Change, call: pytest.CallInfo[None], drives: "Sequence[DriveResult]"
    ) -> str | None:
        """Return why a failure does not fail the session; `None` if it does.

        Args:
            change: How the test differs from the baseline.
            call: What failed.
            drives: The drives that it may be about.
        """
        if self._file is not None:
            if self._mode != "compare":
                return "goes into the baseline"
            return "failed in the baseline" if change == "known" else None
        from oodscen.pytest_plugin._counting import is_counted

        if call.excinfo is None:
            return None
        is_assertion = call.excinfo.errisinstance((AssertionError, pytest.fail.Exception))
        if is_assertion and is_counted(drives, self._bars):
            return "counted by --oodscen-require"
        return None

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Collect what the reports of all processes carry."""
        self._is_cut_short |= report.when not in _PHASES
        carried: Mapping[str, Any] | None = getattr(report, "oodscen", None)
        if carried is None or hasattr(self._config, "workerinput"):
            return
        from oodscen.data._drive_result import DriveResult

        if "test" in carried:
            self._tests[carried["test"]] = KnownTest.parse(carried["known"])
            self._changes[carried["test"]] = carried["change"]
        for row in carried["drives"]:
            result = DriveResult.parse(row)
            before = self._drives.get(result.id)
            if before is None or before.passed:  # Of several drives by one stack the worst counts.
                self._drives[result.id] = result

    def pytest_keyboard_interrupt(self) -> None:
        """Note that Ctrl-C or `pytest.exit` ends the session; its exit code may be that of a whole one."""
        self._is_cut_short = True

    @pytest.hookimpl(tryfirst=True)
    def pytest_sessionfinish(self, session: pytest.Session, exitstatus: int) -> None:
        """Grade the stacks, write the baseline, and fail the session where a stack does not meet the bars."""
        has_ended = exitstatus in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED)
        self._is_cut_short |= bool(session.shouldfail or session.shouldstop)
        self._is_whole = has_ended and not self._is_cut_short
        if hasattr(self._config, "workerinput") or not self._is_whole or self._collects_only:
            return
        try:
            if self._file is not None and self._tests:
                if self._mode == "update":
                    update(self._file, self._tests)
                elif self._mode == "write":
                    KnownOutcomes(tests=self._tests).write(self._file)
            if self._bars and not self._meets():
                session.exitstatus = pytest.ExitCode.TESTS_FAILED
        except OodscenError as error:  # The other hooks still have their reports to write.
            self._fault = f"oodscen: {error}"
            session.exitstatus = pytest.ExitCode.TESTS_FAILED

    def _meets(self) -> bool:
        """Grade the stacks, and return whether there are any and all meet the requirement."""
        from oodscen.judging._drive_requirements import drive_requirements

        self._grades = drive_requirements(
            self._drives.values(), self.study.scenarios, self._bars, seed=self.study.config.seed
        )
        return self._is_met

    @property
    def _is_met(self) -> bool:
        return bool(self._grades) and all(grade.grade == "meets" for grade in self._grades)

    def _verdict(self) -> list[str]:
        """Return whether the requirement is met, if stacks are graded."""
        if not self._grades:
            return []
        bars = ",".join(map(str, self._bars))
        if self._is_met:
            return [f"requirement met: {bars}"]
        return [f"requirement not met, so the session fails: {bars}"]

    def pytest_report_header(self) -> str:
        """Return the line about the study at the top of the report."""
        return f"oodscen: {self._folder}"

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        """Print the stacks' figures, their grades, and what changed since the baseline."""
        from oodscen.pytest_plugin._summary import stack_lines

        lines = [*stack_lines(self._drives.values()), *map(str, self._grades), *self._verdict()]
        lines += self._baseline_lines() if self._fault is None else [self._fault]
        if self._bars and not self._grades and not self._collects_only:
            lines.append(
                "no stack drove a scene, so none can meet --oodscen-require"
                if self._is_whole or not (self._drives or self._is_cut_short)
                else "not all tests ran, so that no stack is graded by --oodscen-require"
            )
        if lines:
            terminalreporter.write_sep("-", "oodscen")
            for line in lines:
                terminalreporter.write_line(printable(line))

    def _baseline_lines(self) -> list[str]:
        """Return how the outcomes differ from the baseline, or where they were written."""
        if self._file is None or not self._tests:
            return []
        from oodscen.pytest_plugin._summary import change_lines, written_line

        if not self._is_whole:
            return [f"{self._file}: not all tests ran, so that nothing is written or compared"]
        if self._mode != "compare":
            return [written_line(self._file, self._tests)]
        return change_lines(self._file, self._tests, self._changes)


def _parse_bars(text: str | None) -> "tuple[Bar, ...]":
    if text is None:
        return ()
    from oodscen.judging._drive_requirements import DRIVE_FIGURES
    from oodscen.judging._leaderboard.requirements import parse_requirement

    return parse_requirement(text, DRIVE_FIGURES)


def _scenes_per_path(text: str | None) -> int | None:
    """Return the number of scenes per path; `None` for all.

    Raises:
        UsageError: If it is not a positive number.
    """
    if text is None:
        return None
    if not re.fullmatch(r"0*[1-9]\d{0,5}", text):
        raise UsageError(f"oodscen_per_path: {text!r:.40} is not a number of scenes")
    return int(text)


def _scene_of(item: pytest.Item) -> "Scene | None":
    """Return the scene of the study that a test is run for."""
    callspec = getattr(item, "callspec", None)
    scene: Scene | None = callspec.params.get(PARAMETER) if callspec else None
    return scene
