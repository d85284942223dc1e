"""The part of the page about driving stacks: every driver over scenes and twins."""

from markupsafe import Markup

from oodscen.judging._drives import DriveBoard, DriveRow, Share, drive_board, remarks
from oodscen.judging._leaderboard.board import Figure
from oodscen.report._charts import svg as charts
from oodscen.report._load import Material
from oodscen.study import Study

_HEADS = (
    ("Drives and passes", "in both, moving on in the twin"),
    ("Progress", "100 %: kept its speed"),
    ("Passed", "no contact, on the road"),
    ("Collisions", ""),
    ("Off the road", ""),
    ("Least TTC", "mean, s; drives below 1.5 s"),
    ("Least headway", "mean, s"),
    ("Hardest braking", "mean, m/s²"),
    ("Jerk", "mean peak, m/s³"),
    ("Against rule-based", "points; p, clustered"),
)


def part(study: Study, found: Material) -> Markup:
    """Show the results of `oodscen drive` in `drives.jsonl`; empty without that file."""
    if not found.drives:
        return Markup("")
    seed = found.config.get("seed")
    board = drive_board(found.drives, found.scenarios, seed=seed if isinstance(seed, int) else 0)
    heads = Markup("").join(
        Markup('<th scope="col">{}{}</th>').format(
            name, Markup("<small>{}</small>").format(small) if small else ""
        )
        for name, small in _HEADS
    )
    rows = Markup("").join(_row(board, row) for row in board.rows)
    said = Markup("").join(
        Markup('<p class="note"><strong><bdi>{}</bdi></strong></p>').format(one)
        for one in remarks(board)
    )
    return Markup(
        "<p>Each stack drives every scene, and its ordinary twin, all the way in closed loop; the drive ends at a "
        "collision or off the road. <em>Drives and passes</em> is the figure to go by: it passed the scene and "
        "its twin, and came at least half as far in the twin as keeping the speed would. Who never moves touches "
        "nothing, and scores 0 there. “rule-based” is the shipped follower with perfect perception. Ranges are 95 % "
        "intervals that resample whole paths.</p>{}"
        '<div class="scroll" role="region" aria-label="Driving stacks" tabindex="0"><table class="drives">'
        '<thead><tr><th scope="col">Driver</th>{}</tr></thead><tbody>{}</tbody></table></div>{}'
    ).format(said, heads, rows, _pairs(board))


def _row(board: DriveBoard, row: DriveRow) -> Markup:
    paired = row.paired
    test = paired.against_rule_based if paired else None
    against = ""
    if test is not None:
        p = "< 0.001" if test.p_clustered < 0.001 else f"{test.p_clustered:.3f}"
        against = Markup("{}<small>p {}</small>").format(charts.signed(100 * test.difference, 0), p)
    failed = Markup('<small class="wrap">{} failed to run</small>').format(row.failed)
    cells = (
        _share(paired.drives_and_passes) if paired and paired.n else _none(),
        _mean(row.means["progress"], percent=True),
        _share(row.shares["passed"]),
        _share(row.shares["collisions"]),
        _share(row.shares["off_road"]),
        Markup("{}<small>{} of {}</small>").format(
            _mean(row.means["min_ttc_s"]), row.shares["critical"].hits, row.shares["critical"].n
        ),
        _mean(row.means["min_headway_s"]),
        _mean(row.means["peak_deceleration"]),
        _mean(row.means["peak_jerk"]),
        against or _none(),
    )
    return Markup('<tr{}><th scope="row"><bdi>{}</bdi><small>{} {}</small>{}</th>{}</tr>').format(
        Markup(' class="reference-row"') if row.items == "twins" else "",
        row.driver,
        row.n,
        "scenes" if row.items == "scenes" else "ordinary twins",
        failed if row.failed else "",
        Markup("").join(Markup("<td>{}</td>").format(cell) for cell in cells),
    )


def _pairs(board: DriveBoard) -> Markup:
    """Describe the results of every driver in the scenes and in their twins."""
    lines = []
    for row in board.rows:
        pair = row.paired
        if pair is None or not pair.n:
            continue
        cost = pair.progress_lost.value
        needless = pair.brakes_needlessly
        lines.append(
            Markup(
                "<li><bdi>{}</bdi>: of {} pairs {} passed both, {} only the twin (what the hazard cost), {} only the "
                "scene, {} neither{}{}.</li>"
            ).format(
                row.driver,
                pair.n,
                pair.both,
                pair.twin_only,
                pair.scene_only,
                pair.neither,
                "" if cost is None else f"; the hazard costs {100 * cost:.0f} points of progress",
                f"; it brakes hard without need in {needless.hits} of {needless.n} twins"
                if needless.n
                else "",
            )
        )
    if not lines:
        return Markup("")
    return Markup("<p>Paired with the twin:</p><ul>{}</ul>").format(Markup("").join(lines))


def _share(share: Share) -> Markup:
    if share.value is None:
        return _none()
    bounds = ""
    if share.interval is not None:
        low, high = 100 * share.interval.low, 100 * share.interval.high
        bounds = Markup("<small>{:.0f} to {:.0f} %</small>").format(low, high)
    return Markup("<b>{:.0f} %</b><small>{} of {}</small>{}").format(
        100 * share.value, share.hits, share.n, bounds
    )


def _mean(mean: Figure, percent: bool = False) -> Markup:
    if mean.value is None:
        return _none()
    scale, unit, digits = (100, " %", 0) if percent else (1, "", 1)
    bounds = ""
    if mean.interval is not None:
        low, high = scale * mean.interval.low, scale * mean.interval.high
        bounds = Markup("<small>{:.{d}f} to {:.{d}f}{}</small>").format(low, high, unit, d=digits)
    return Markup("{:.{d}f}{}{}").format(scale * mean.value, unit, bounds, d=digits)


def _none() -> Markup:
    return Markup('<span class="none">–</span>')
