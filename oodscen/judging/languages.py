"""What answers in other languages than English say: actions, yes and no, refusals, denials.

German, French, Spanish, Chinese and Japanese, in the words in which short answers come. All patterns are
for text that `oodscen.judging.wording.normalise` returned: lower case, `\u00df` as `ss`.
"""

import re
from collections.abc import Mapping

_GAP = r"[^.;,\n]{0,25}?"


def _either(*patterns: str) -> str:
    return "|".join(patterns)


def _aside(german: str, french: str, spanish: str, sign: str) -> str:
    """Return how one changes to one side."""
    return _either(
        rf"(?:auf|in)\s+die\s+{german}e\s+(?:fahr)?spur(?:\s+(?:zu\s+)?(?:wechseln|fahren|ausweichen))?",
        rf"(?:nach\s+)?{german}s?\s+(?:auszuweichen|ausweichen|wechseln|ausscheren|\u00fcberholen|vorbeifahren)",
        rf"(?:spurwechsel|ausweichen|wechs(?:le|eln)|weiche)\s+nach\s+{german}s?",
        rf"(?:chang|d\u00e9port|d\u00e9pass|d\u00e9cal|pass|roul|serr|tourn)\w*{_GAP}\s(?:(?:\u00e0|de)\s+)?{french}",
        rf"(?:cambi|mov|muev|gir|pas|adelant|desvi|esquiv)\w*{_GAP}\s{spanish}",
        rf"(?:\u5411|\u5f80|\u6362\u5230|\u53d8\u9053\u5230|\u53d8\u9053\u81f3|\u53d8\u66f4\u5230|\u5207\u6362\u5230){sign}(?:\u4fa7|\u8fb9)?(?:\u53d8\u9053|\u6362\u9053|\u8f66\u9053|\u5e76\u7ebf|\u53d8\u66f4\u8f66\u9053)",
        rf"{sign}(?:\u4fa7|\u8fb9)?(?:\u53d8\u9053|\u6362\u9053)",
        rf"{sign}(?:\u5074)?(?:\u306e)?(?:\u8eca\u7dda)?(?:\u3078|\u306b)(?:\u8eca\u7dda)?(?:\u3092)?(?:\u5909\u66f4|\u79fb\u52d5|\u907f\u3051)",
        rf"{sign}\u8eca\u7dda\u5909\u66f4",
    )


FOREIGN_ACTIONS: Mapping[str, str] = {
    "emergency_brake": _either(
        r"\b(?:voll|not|gefahren)brems\w*",
        r"\b(?:stark|hart|scharf|kr\u00e4ftig|voll)\s+(?:ab)?(?:zu)?brems\w*",
        r"\bfrein\w*\s+(?:brusque\w*|d'urgence|(?:tr\u00e8s\s+)?fort|\u00e0\s+fond|brutale\w*)",
        r"\bfren\w*\s+(?:de\s+emergencia|bruscamente|a\s+fondo|fuerte\w*|en\s+seco)|\bfrenazo",
        r"\u7d27\u6025(?:\u5239\u8f66|\u5236\u52a8|\u505c\u8f66)|\u7dca\u6025(?:\u7159\u8eca|\u5239\u8eca|\u30d6\u30ec\u30fc\u30ad|\u5236\u52d5|\u505c\u6b62)|\u6025(?:\u5239\u8f66?|\u30d6\u30ec\u30fc\u30ad|\u505c\u8eca|\u505c\u6b62)|\u731b\u8e29\u5239\u8f66",
    ),
    "stop": _either(
        r"\ban(?:zu)?halten\b|\bhalte\b[^.;,\n]{0,20}\ban\b|\bstehen\s?(?:zu)?bleiben\b|\bstoppen\b|\bzum\s+stillstand\b(?:\s+(?:kommen|bremsen))?",
        r"\b[sm]'arr\u00eate\w*|\barr\u00eat(?:er|ez)\b|\barr\u00eat\s+complet\b",
        r"\bdeten(?:er\w*|ga\w*|dr\u00eda)\b|\bdet\u00e9n\b|\bparar(?:se|\u00eda)?\b",
        r"\u505c(?:\u8f66|\u4e0b|\u4f4f|\u6b62|\u8eca)(?!\u7ebf|\u573a|\u6807|\u724c|\u4f4d|\u7dda|\u4e2d)|\u6b62\u307e(?:\u308b|\u308a|\u3063\u3066)",
    ),
    "slow_down": _either(
        r"\blangsamer\b(?:\s+(?:zu\s+)?(?:fahren|werden))?|\bverlangsam\w*|\b(?:geschwindigkeit|tempo)\s+(?:zu\s+)?(?:verringern|reduzieren|senken|drosseln)|\bvom\s+gas\b(?:\s+gehen)?",
        r"\bralenti\w*|\br\u00e9dui\w+\s+(?:la\s+|sa\s+|ma\s+)?vitesse|\blever\s+le\s+pied",
        r"\b(?:reduc|reduz|disminu|baj|aminor)\w+\s+(?:la\s+|mi\s+|su\s+)?(?:velocidad|marcha)|\bdesaceler\w+|\bfrenar\s+suavemente",
        r"\u51cf\u901f|\u6e1b\u901f|\u653e\u6162|\u964d\u4f4e\u8f66?\u901f|\u5f90\u884c|(?:\u901f\u5ea6|\u30b9\u30d4\u30fc\u30c9)\u3092(?:\u843d|\u4e0b)",
    ),
    "keep_speed": _either(
        r"\b(?:geschwindigkeit|tempo)\s+(?:zu\s+)?(?:bei(?:zu)?be)?halten|\bweiter(?:zu)?fahren\b",
        r"\b(?:garder|maintenir|conserver)\s+(?:la\s+|sa\s+|ma\s+)?(?:m\u00eame\s+)?vitesse|\bcontinuer\b(?:\s+tout\s+droit)?(?:\s+\u00e0\s+la\s+m\u00eame\s+vitesse)?",
        r"\b(?:mantener|conservar|mantendr\u00eda)\s+(?:la\s+|mi\s+|su\s+)?velocidad|\bseguir\s+(?:recto|igual|adelante)|\bcontinuar\b",
        r"\u4fdd\u6301(?:\u5f53\u524d|\u73b0\u6709|\u539f\u6709?)?\u7684?(?:\u8f66\u9053\u548c)?(?:\u8f66\u901f|\u901f\u5ea6|\u5300\u901f|\u539f\u901f)|\u7ee7\u7eed(?:\u76f4\u884c|\u884c\u9a76|\u524d\u8fdb)|\u901f\u5ea6\u3092(?:\u7dad\u6301|\u4fdd)|\u305d\u306e\u307e\u307e(?:\u8d70\u884c|\u76f4\u9032|\u9032)|\u73fe\u72b6\u7dad\u6301",
    ),
    "change_lane_left": _aside("link", "gauche", "izquierd[oa]", "\u5de6"),
    "change_lane_right": _aside("recht", "droite", "derech[oa]", "\u53f3"),
    "pull_over": _either(
        r"\brechts\s+ran(?:fahren)?|\b(?:am|an\s+den)\s+(?:rechten\s+)?(?:strassen|fahrbahn)?rand\b(?:\s+(?:fahren|(?:an)?halten|(?:und|zu)\s+(?:an)?halten))?|\b(?:auf|an)\s+de[nm]\s+(?:stand|seiten)streifen\b(?:\s+(?:und\s+)?\w*(?:halten|fahren))?",
        r"\b(?:se\s+(?:garer|ranger|rabattre)|s'arr\u00eater)\s+(?:sur|au|le)\s+(?:le\s+|la\s+|long\s+)?(?:bas(?:\s|-)c\u00f4t\u00e9|bord|accotement|bande\s+d'arr\u00eat)[\w ']*",
        r"\borillarse\b|\b(?:apartarse|detenerse|parar(?:se)?)\s+(?:a|en|al)\s+(?:la\s+|el\s+|un\s+)?(?:lado|arc[e\u00e9]n|orilla|borde|costado)[\w ]*",
        r"\u9760(?:\u8fb9|\u53f3)(?:\u505c\u8f66|\u505c\u4e0b)?|\u8def\u8fb9\u505c\u8f66|\u505c(?:\u8f66)?(?:\u5728|\u5230)\u8def(?:\u80a9|\u8fb9)|\u8def\u80a9\u306b(?:\u5bc4|\u505c)\w*",
    ),
}
"""By action id: what it is called."""

DENIAL = re.compile(
    r"\b(?:nicht|kein\w*|ne|n'\w+|pas|\u00e9viter|evitar|zu\s+sp\u00e4t)\b"
    r"|\u4e0d(?!\u9519)|\u522b|\u907f\u514d|\u6ca1|\u7121|\u65e0|\u306a\u3044|\u307e\u305b\u3093|\u907f\u3051\u308b\u3079\u304d"
)
"""In the clause of a name it takes the name back; none of these words is English."""

CONDITION = re.compile(
    r"\b(?:wenn|falls|sonst|ansonsten|sinon|sino|de\s+lo\s+contrario)\b|\u5982\u679c|\u5426\u5219|\u82e5|\u3082\u3057|\u5834\u5408"
)
"""Makes what a clause says hang on something."""

YES_WORD = r"ja|oui|s\u00ed|\u662f\u7684?|\u5bf9|\u6709|\u306f\u3044"
NO_WORD = r"nein|non(?!\s+[a-z])|\u5426|\u4e0d\u662f|\u6ca1\u6709|\u6c92\u6709|\u3044\u3044\u3048"

USUAL = _either(
    r"\bnichts\s+(?:\w+\s+)?(?:ungew\u00f6hnlich|aussergew\u00f6hnlich|auff\u00e4llig|besonder)\w*|\balles\s+(?:\w+\s+)?(?:normal|gew\u00f6hnlich|in\s+ordnung)\b|\bkeine\s+(?:auff\u00e4lligkeit|besonderheit|anomalie)\w*|\bnicht\s+(?:aus?ser|un)gew\u00f6hnlich",
    r"\brien\s+(?:de\s+|d')(?:\w+\s+)?(?:inhabituel|anormal|particulier|sp\u00e9cial)|\btout\s+(?:\w+\s+)?normal\b|\baucune\s+anomalie",
    r"\bnada\s+(?:\w+\s+){0,2}?(?:inusual|anormal|raro|extra\u00f1o|lo\s+com\u00fan|lo\s+normal)|\btodo\s+(?:\w+\s+){0,2}?normal\b|\bninguna\s+anomal\u00eda",
    r"(?:\u6ca1\u6709|\u6c92\u6709|\u65e0|\u672a\u53d1\u73b0)(?:\u4efb\u4f55|\u4ec0\u4e48)?(?:\u660e\u663e)?\u7684?(?:\u5f02\u5e38|\u7570\u5e38|\u4e0d\u5bfb\u5e38)|\u4e00\u5207\u6b63\u5e38|\u7570\u5e38(?:\u306f|\u304c)?(?:\u3042\u308a\u307e\u305b\u3093|\u306a\u3044|\u306a\u3057)|\u666e\u901a\u306e|\u6b63\u5e38\u3067\u3059",
)
"""Says that nothing is out of the ordinary."""

UNUSUAL = (
    r"\b(?:ungew\u00f6hnlich|aussergew\u00f6hnlich|auff\u00e4llig)\w*|\b(?:inhabituel|anormal)\w*"
    r"|\b(?:inusual|anormal|fuera\s+de\s+lo\s+com\u00fan)\b|\u5f02\u5e38|\u4e0d\u5bfb\u5e38|\u7570\u5e38"
)
"""Says that something is, where nothing denies it."""

REFUSAL = _either(
    r"\btut\s+mir\s+leid\b|\b(?:kann|darf|m\u00f6chte)\b[^.;\n]{0,40}\bnicht\b[^.;\n]{0,30}\b(?:helfen|beantworten|sehen|unterst\u00fctzen)",
    r"\bd\u00e9sol\u00e9e?\b|\bje\s+ne\s+(?:peux|suis)\s+pas\b",
    r"\blo\s+siento\b|\bno\s+puedo\b|\bperdona\b",
    r"\u62b1\u6b49|\u5bf9\u4e0d\u8d77|\u5c0d\u4e0d\u8d77|\u65e0\u6cd5|\u7121\u6cd5|\u4e0d\u80fd(?:\u56de\u7b54|\u534f\u52a9|\u63d0\u4f9b|\u5e2e)",
    r"\u7533\u3057\u8a33|\u3067\u304d\u307e\u305b\u3093|\u304a\u7b54\u3048",
)
"""Declines to answer; looked for only where no answer is found."""

SURENESS = (
    r"confid[ea]n[cs]e|confident|certain|sure|probability|likel|score|sicher|konfidenz|confiance|s\u00fbr|confianza|seguridad|segur|certeza"
    r"|\u7f6e\u4fe1\u5ea6|\u786e\u4fe1\u5ea6|\u4fe1\u5fc3|\u628a\u63e1|\u78ba\u4fe1\u5ea6|\u4fe1\u983c\u5ea6|\u78ba\u7387"
)
"""Words for how sure somebody is, or how they begin."""

ANSWER = (
    r"antwort|aktion|entscheidung|wahl|r\u00e9ponse|respuesta|acci\u00f3n|opci\u00f3n|d\u00e9cision"
    r"|\u7b54\u6848|\u7b54\u3048|\u9009\u62e9|\u9078\u64c7|\u56de\u7b54|\u6b63\u89e3|\u89e3\u7b54|\u9078\u629e"
)
"""Words for what is asked for."""

IS = r"ist|est|es|\u662f|\u4e3a|\u306f"
