"""ASAM's quality checkers, in this process."""

import logging
from pathlib import Path

import qc_opendrive.main as roads
import qc_openscenario.main as scenarios
from qc_baselib import Configuration, Result


def issues(path: Path) -> list[str]:
    """Return the issues of one file."""
    logging.disable(logging.CRITICAL)
    checks = roads if path.suffix == ".xodr" else scenarios
    name = checks.constants.BUNDLE_NAME
    settings, result = Configuration(), Result()
    settings.set_config_param("InputFile", str(path))
    settings.register_checker_bundle(checker_bundle_name=name)
    result.register_checker_bundle(name=name, build_date="", description="", version="", summary="")
    result.set_result_version("1")
    checks.run_checks(settings, result)
    return [
        f"{issue.rule_uid}: {issue.description}"
        for checker in result.get_checker_ids(name)
        for issue in result.get_issues(checker_bundle_name=name, checker_id=checker)
    ]
