"""The words that name each action in prose."""

_THE = r"(?:(?:the|my|your|its|our|a|same|current|constant) )*"
_GENTLY = r"(?: (?:gently|gradually|slightly|carefully|smoothly|comfortably|safely))?"
_SIDE = r"(?:right )?(?:(?:hard )?shoulder|(?:side|edge)(?: of the road)?)"
_RIGHT = rf"(?:{_SIDE}|right(?! (?:hand )?lane))"


def _lane_change(side: str) -> str:
    lane = rf"(?:in|on)?(?:to )?(?:the )?(?:next )?(?:{side}(?: hand)?(?: lane)?|lane (?:to|on) the {side})"
    rest = "(?:, even if it is for oncoming traffic)?" if side == "left" else ""
    return (
        rf"(?:chang|mov|merg|swerv|steer|shift|switch|veer)(?:e|ing)? (?:the )?(?:over )?(?:lanes? )?{lane}{rest}"
        rf"|{side} lane change|lane change,? {lane}"
    )


ACTION_WORDS = {
    "pull_over": (
        rf"(?:slow down(?:,| and) )?(?:pull(?:ing)? ?over|mov(?:e|ing) (?:over )?(?:in|on)?to the {_SIDE}|pull(?:ing)? (?:in|on)?to the {_RIGHT})"
        rf"(?: to the {_RIGHT})?(?: or the shoulder)?(?:,? and (?:stop|park|wait)(?: there)?)?"
        rf"|(?<!bus )(?:stop|park)(?:p?ing)? (?:on|at) the {_RIGHT}"
    ),
    "emergency_brake": (
        r"(?:emergency|panic|full|hard|maximum) brak(?:e|ing)|emergency stop(?:ping)?"
        r"|(?:keep the lane and )?brak(?:e|ing) (?:hard|sharply|fully|as hard as (?:possible|i can|the road allows))"
        r"|slam(?:ming)? (?:on )?the brakes?|apply(?:ing)? (?:(?:full|emergency) (?:brakes|braking)|the brakes (?:fully|hard))"
    ),
    "change_lane_left": _lane_change("left"),
    "change_lane_right": _lane_change("right"),
    "stop": (
        rf"(?:keep the lane and )?(?:com(?:e|ing)|brak(?:e|ing)|slow(?:ing)?(?: down)?|bring(?:ing)? (?:the|my|our) (?:ego )?(?:car|vehicle)){_GENTLY} to an?"
        r" (?:(?:complete|full|controlled|safe|smooth) )*(?:stop|halt|standstill)|(?:a )?(?:complete|full|controlled) stop"
        r"|(?<!bus )(?<!non )(?<!truck )stop(?:ping)?(?: the (?:car|vehicle|ego vehicle))?"
        r"(?! ?(?:signs?|lines?|lights?|signals?|at nothing|\w+ing\b))|halt(?:ing)?"
    ),
    "slow_down": (
        rf"(?:keep the lane and )?slow(?:ing)? ?down{_GENTLY}(?: to half the speed)?|decelerat(?:e|ing){_GENTLY}"
        rf"|(?:reduc|lower)(?:e|ing)? {_THE}speed|brak(?:e|ing) (?:gently|lightly|softly|slightly)|gentle braking"
    ),
    "keep_speed": (
        rf"(?:keep|maintain|hold)(?:ing)? {_THE}(?:lane and (?:the )?)?speed(?: and lane)?(?! (?:low|down|slow|under(?! any)|below|of)\b)"
        rf"|(?:keep (?:going|driving)|continue(?: driving| straight| ahead)?)(?: at {_THE}speed)(?! of\b)"
        r"|keep(?:ing)? (?:going|driving)|continu(?:e|ing) (?:driving|straight|ahead)"
        r"|continue(?= ?(?:[.!]|$|because\b|since\b))|(?<![^\n])keeps (?:its|the) (?:lane and (?:the )?)?speed(?= ?(?:[.!\n]|$))"
    ),
}
"""Names of each action as a pattern over folded prose; if two start together, the first one wins."""
