"""Faults found while data are validated, as issues with paths."""

from collections.abc import Iterable, Sequence

from pydantic import ValidationError

from oodscen.errors import Issue

MOST_PARTS = 40
"""Maximum number of parts of a thing made to order, and of those in a group."""
_MAX_NAME = 80
"""Length to which a name in the path of an issue is cut, in characters."""


class IssuesError(ValueError):
    """Raised by validators that check a value as a whole and can find several faults at once."""

    def __init__(self, issues: Sequence[Issue]) -> None:
        self.issues = tuple(issues)
        super().__init__("; ".join(map(str, issues)))


def same_length(**lengths: int) -> None:
    """Refuse fields that belong together if their lengths differ.

    Raises:
        ValueError: With the length of each.
    """
    if len({*lengths.values()}) > 1:
        told = ", ".join(f"{length} in {name}" for name, length in lengths.items())
        raise ValueError(f"lengths differ: {told}")


def issues_of(error: ValidationError) -> list[Issue]:
    """Convert pydantic's errors into issues with paths such as `actors[2].placement.lane`."""
    issues = []
    found = error.errors(include_url=False, include_input=False)
    long: dict[str, None] = {}
    for item in found:
        if (whole := _overlong(item["loc"])) is not None:
            long[dotted(whole)] = None
            continue
        inside = (one["loc"][: len(item["loc"])] == item["loc"] != one["loc"] for one in found)
        if item["type"] == "too_short" and any(inside):
            continue  # Faulty elements are named, and pydantic does not count them.
        path = dotted(item["loc"])
        cause = item.get("ctx", {}).get("error")
        if isinstance(cause, IssuesError):
            issues += below(path, cause.issues)
        else:
            issues.append(Issue(path, item["msg"].removeprefix("Value error, ")))
    for path in long:
        issues = [issue for issue in issues if not issue.path.startswith(f"{path}[")]
        issues.append(Issue(path, f"at most {MOST_PARTS} parts are allowed"))
    return issues


def _overlong(location: tuple[str | int, ...]) -> tuple[str | int, ...] | None:
    """Return the list of parts in which a fault lies beyond the last that is allowed.

    pydantic counts the sound elements of a list only, so it would tell thousands of faults, and not that there are
    too many.
    """
    for k in range(1, len(location)):
        one, index = location[k - 1], location[k]
        is_details = k > 1 and location[k - 2] == "details"
        is_part = one in ("parts", "otherwise") and not is_details
        if is_part and isinstance(index, int) and index >= MOST_PARTS:
            return location[:k]
    return None


def below(path: str, issues: Iterable[Issue]) -> list[Issue]:
    """Return the issues of a part as issues of the whole, in which the part has a path."""
    found = []
    for issue in issues:
        joint = "." if path and issue.path and not issue.path.startswith("[") else ""
        found.append(Issue(f"{path}{joint}{issue.path}", issue.message))
    return found


def _brief(name: str) -> str:
    return name if len(name) <= _MAX_NAME else f"{name[:_MAX_NAME]}..."


def dotted(location: Iterable[str | int]) -> str:
    """Return a location as an indexing expression, e.g. `actors[2].placement.lane`."""
    text = ""
    for part in location:
        # A key that nobody knows may be as long as its writer likes.
        text += f"[{part}]" if isinstance(part, int) else f".{_brief(part)}"
    return text.removeprefix(".")
