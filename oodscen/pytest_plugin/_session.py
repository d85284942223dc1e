"""The hooks of a session that names a study: scenes as parameters, reports, grades and the baseline."""

import os
import re
from collections.abc import Generator, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from oodscen._io.study_files import refuse_inside
from oodscen._words.text import printable
from oodscen.errors import OodscenError, UsageError
from oodscen.pytest_plugin._baseline import Change, KnownTest, Outcome
from oodscen.pytest_plugin._comparison import BaselineComparison
from oodscen.pytest_plugin._grading import StackGrades
from oodscen.pytest_plugin._hooks import path_setting, setting
from oodscen.pytest_plugin._subtests import Subtests

if TYPE_CHECKING:
    from oodscen.data._catalogue import Catalogue
    from oodscen.data._drive_result import DriveResult
    from oodscen.data._scene import Scene
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
        self._fault: str | None = None
        """The error that kept the baseline or the grades from being made."""
        self._is_whole = False
        """True once all tests have run."""
        self._is_cut_short = False
        """True once a process has died, or Ctrl-C, `pytest.exit` or the last failure that `-x` allows has come."""
        self._registered_marks: set[str] = set()
        try:
            self._grades = StackGrades(setting(config, "oodscen_require"))
            self._per_path = _scenes_per_path(setting(config, "oodscen_per_path"))
            self._baseline = BaselineComparison(
                path_setting(config, "oodscen_baseline"),
                config.getoption("oodscen_baseline_mode") or "compare",
            )
        except OodscenError as error:
            raise pytest.UsageError(printable(str(error))) from None

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
        test = self._baseline.test_id(item)
        change = self._baseline.change(test, outcome, known_test.scene)
        if report.failed and drive is not None:
            self._add_sections(report, drive)
        self._add_properties(item, report, scene, drive, change)
        own_drives = subtests.own_drives(drive, call) if drive else []
        forgiven: list[DriveResult] = []
        reason = subtests.all_forgiven if report.passed and subtests.is_over else None
        if report.failed:
            if self._baseline.has_file:
                reason = self._baseline.forgives(change)
            else:
                reason = self._grades.forgives(call, own_drives)
                forgiven = own_drives if reason else []
            subtests.forgiven.append(reason)
        if reason:
            report.outcome = "skipped"
            vars(report)["wasxfail"] = f"reason: {reason}"
        vars(report)["oodscen"] = {
            "test": test,
            "known": known_test.model_dump(),
            "change": change,
            "drives": driven,
            "forgiven": [result.model_dump(mode="json") for result in forgiven],
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
        if self._baseline.has_file and change is not None:
            properties.append(("oodscen.change", change))
        if drive is not None:
            properties += drive_properties(drive)
        # Reports of subtests before have left fewer of the same names.
        item.user_properties = with_properties(item.user_properties, properties)
        report.user_properties = list(item.user_properties)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Collect what the reports of all processes carry."""
        self._is_cut_short |= report.when not in _PHASES
        carried: Mapping[str, Any] | None = getattr(report, "oodscen", None)
        if carried is None or hasattr(self._config, "workerinput"):
            return
        if "test" in carried:
            self._baseline.add(carried["test"], carried["known"], carried["change"])
        self._grades.add(carried["drives"], carried.get("forgiven", ()))

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
            self._baseline.save()
            if self._grades.are_required and not self._grades.meets(self.study):
                session.exitstatus = pytest.ExitCode.TESTS_FAILED
        except OodscenError as error:  # The other hooks still have their reports to write.
            self._fault = f"oodscen: {error}"
            session.exitstatus = pytest.ExitCode.TESTS_FAILED

    def pytest_report_header(self) -> str:
        """Return the line about the study at the top of the report."""
        return f"oodscen: {self._folder}"

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        """Print the stacks' figures, their grades, and what changed since the baseline."""
        lines = self._grades.lines()
        lines += [self._fault] if self._fault else self._baseline.lines(is_whole=self._is_whole)
        if not self._collects_only:
            lines += self._grades.missing(is_whole=self._is_whole, is_cut_short=self._is_cut_short)
        if lines:
            terminalreporter.write_sep("-", "oodscen")
            for line in lines:
                terminalreporter.write_line(printable(line))


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
