"""Tells words that name an aspect from words that say that there is none.

Every word is of a kind, and the kinds of a clause tell what it says. A clause of known words alone denies what is odd,
or calls something ordinary. One with other words names a thing ("a truck without lights"), unless a denial or an
ordinary word comes first: "I see no trucks" names none, and what it says is open.
"""

import re

from oodscen._prose import fold, tidy

ODD = (
    r"(?:unusual|out of the ordinary|abnormal|anomalous|strange|odd|weird|out of place|out of distribution|ood"
    r"|remarkable|notable|noteworthy|of (?:note|interest)|special|suspicious|concerning|wrong(?! way)|amiss)"
)
_KINDS = {
    "p": r"drivers?(?:'s)?|riders?|(?:(?:head|tail|brake|traffic|street) ?)?lights|(?:traffic|street|brake) (?:light|signal)|markings?|lines"
    r"|signs?(?! of\b)|signals|wheels?|t[iy]res?|barriers?|guard ?rails?|(?:hold|secure|support|mark|protect|separate|cover)s",
    "n": r"not(?! (?:all|every)\w*)|never|neither|(?:hard|bare|scarce|rare)ly|far from|anything but|no longer|free (?:of|from)|lacks?",
    "z": "nothing",
    "y": "no|none|without",
    "q": "nobody|no one",
    "O": rf"{ODD}|(?:abnormal|unusual|strange|odd)ly|unexpected|to (?:report|note|mention)|worth (?:noting|mentioning)",
    "T": r"(?:any|some|every)thing|all|(?:aspect|thing|object|element|feature|event|detail|part|obstacle|obstruction|problem|issue|concern"
    r"|behaviou?r|danger|threat|hazard(?! (?:warning )?(?:light|triangle)s?\b))s?|(?:anomal|abnormalit|irregularit|activit)(?:y|ies)|stands? out|deviat(?:ions?|es?)(?: from (?:the )?\w+)?",
    "N": "(?:normal|ordinary|usual|typical|routine|regular|standard)(?:ly)?|ordinarily|as expected|(?:with)?in (?:the )?distribution",
    "w": "fine|clear|dry|quiet|good|ok|okay|smooth(?:ly)?",
    "S": "(?:image|picture|photo|frame|view|video|sequence|scene|scenario|situation|drive|road|street|traffic|highway|motorway|lane|intersection"
    "|junction|weather|condition|environment|setting)s?|it|this",
    "V": "(?:car|vehicle)s?",
    "r": "n?or",
    "a": "an?|the|than|otherwise|in|on|about|with|of|at|to|for|from|along|through",
    "f": r"am|is|are|was|were|be|been|being|has|have|had|do|does|did|can|could|would|seems?|appears?|looks?|shows?|shown|showing|contains?|depicts?|includes?"
    r"|see|seen|notice[ds]?|found|(?:find|detect|spot|observe|report)(?:s|e?d)?|identif(?:y|ied)|present|visible|apparent|happening|occurring|going on"
    r"|flow(?:s|ing)?|mov(?:es?|ing)|behav(?:es?|ing)|driv(?:es|ing)|i|we|they|there|here|that|these|those|which|both|every|any|some|other|few|several"
    r"|like|as|just|only|quite|very|so|now|far|ahead|around|urban|suburban|rural|city|residential|daytime|light(?= traffic)"
    r"|given|considered|(?:sign|trace|indication|evidence|presence)s? of|\w{4,}ly",
    "x": r"[\w']+",
}
"""The words of every kind: what should be there (`p`: a driver, what "holds" a load), denials (`n`, `z`, `y`, `q`), odd
ones, those odd unless denied, ordinary ones (`N`, and `w`, about the scene only), the scene, cars, "or", articles and
prepositions, others that tell nothing, and unknown ones."""
_WORD = re.compile(
    "|".join(rf"(?P<{kind}>(?<![\w'])(?:{words})(?![\w']))" for kind, words in _KINDS.items())
)


def plain_words(words: str) -> str:
    """Return words folded and without contractions."""
    plain = re.sub(r"\bcan(?:not|'t)\b", "can not", fold(tidy(words)))
    plain = re.sub(r"n't\b", " not", plain).replace("i'm ", "i am ")
    return re.sub(r"\b(it|that|there|\w+thing)'s\b", r"\1 is", plain)


def says_nothing(plain: str) -> bool | None:
    """Return whether plain words say that there is no aspect; `None` if that is open."""
    said = _clauses_said(plain)
    if not said or _DENIAL.fullmatch(said):
        return True
    return False if _NAME.fullmatch(said) else None


def denies_what_is_odd(plain: str) -> bool:
    """Return whether plain words name no aspect, and a clause denies what is odd."""
    said = _clauses_said(plain)
    return "-" in said and _DENIAL.fullmatch(said) is not None


def goes_with_no(plain: str) -> bool:
    """Return whether plain words add nothing to an answer of no."""
    return _DENIAL.fullmatch(f"-{_clauses_said(plain)}") is not None


def goes_with_yes(plain: str) -> bool:
    """Return whether no clause of plain words takes an answer of yes back or leaves it open."""
    return not re.search("[-0?]", _clauses_said(plain))


def _clauses_said(plain: str) -> str:
    """Return what the clauses of plain words say, one letter each.

    Nothing is odd (`-`), there is nothing, or the scene is clear (`0`), a thing is not there that may be (`d`) or should
    be (`a`), something is odd (`o`, or `+` if it is called not ordinary), there is a thing (`x`, or `v` in known words),
    it is open (`?`), or hardly anything (`.`).
    """
    kinds = (
        "".join(str(word.lastgroup) for word in _WORD.finditer(clause))
        for clause in _CLAUSES.split(_FILLER.sub("none", plain))
    )
    return "".join(map(_said, filter(None, kinds)))


def _said(kinds: str) -> str:
    if len(kinds) > _LONGEST_CLAUSE:
        return "?"
    if re.search("[xp]", kinds):
        return next(said for said, form in _UNKNOWN if form.search(kinds))
    kinds = re.sub("w(?=[fwSV]*[OT])", "f", kinds)
    is_denied = is_odd = is_ordinary = False
    for kind in kinds:
        is_denied ^= kind in "nzyq"
        is_odd |= kind in ("Nw" if is_denied else "O")
        is_ordinary |= kind in ("OT" if is_denied else "Nw")
    if is_odd:
        return "+" if re.search("[nzyqN]", kinds) else "o"
    if is_ordinary:
        return "-" if re.search("[NOT]", kinds) else "0" if re.search("[SV]", kinds) else "d"
    return next(said for said, form in _KNOWN if form.search(kinds))


_LONGEST_CLAUSE = 200
"""The longest clause that is looked into, in words."""
_LISTED = r"(?= with\b|(?: (?!no\b|not|is\b|are\b)\w+,?){0,6} n?or\b)"
_CLAUSES = re.compile(
    rf"(?:(?!,{_LISTED})[,.;:!?()\n\u2013\u2014])+|(?<=\s)-|\b(?:and|but)\b|\bwith(?= (?:no|nothing)\b)"
)
"""Matches what stands between clauses, which the commas of "no deer, dogs or cows" and "a road, with cars" do not."""
_FILLER = re.compile(
    r"\A\W*(?:nil|null|false|n/?a|not applicable|unknown|undefined|nope|nah|zero|absent|empty)(?!-\w)(?=\W*\Z| ?[(,.;:\u2013\u2014-]| (?:here|in|for)\b)"
)
"""Matches what fills the place of an aspect, as "none" does."""
_KNOWN = (
    ("0", re.compile("^[farS]*(?:z[farS]*|yf*(?:a[farS]*)?)$")),
    ("x", re.compile("V.*[nzyq]")),
    ("d", re.compile("[zy]")),
    ("?", re.compile("[nq]")),
    ("v", re.compile("[VT]")),
    (".", re.compile("")),
)
"""The forms of a clause of known words that calls nothing odd or ordinary; it says that of the first one found."""
_FIRST = "^[^xpV]*"
_UNKNOWN = (
    ("-", re.compile("^[farSV]*[nzy][fawS]*x{1,2}[OSV]?T[farSTV]*$")),
    ("?", re.compile(rf"[nzyq](?:[^xOT]*x{{1,3}}r)*[^xOT]*[OT]|{_FIRST}N|(?<![an])N")),
    ("a", re.compile(rf"{_FIRST}(?:[yq][faSw]*x?[faSw]*|z)p")),
    ("d", re.compile("^[faSw]*(?:y[faw]*x{1,2}[faS]*$|z)")),
    ("?", re.compile(rf"{_FIRST}[nzyq]")),
    ("x", re.compile("")),
)
"""The forms of a clause with unknown words."""
_DENIAL = re.compile(r"[d.]*[-0][-0d.]*")
"""Matches what clauses say of which none names an aspect, and one says that there is none."""
_NAME = re.compile(r"[.o+]*(?:[xv].*|a[^-0]*)|[.o]+")
"""Matches what clauses say that name an aspect; a denial behind the name of a thing denies nothing of it."""
