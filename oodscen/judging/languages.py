"""What answers in other languages than English say: actions, yes and no, refusals, denials.

German, French, Spanish, Chinese and Japanese, in that order, in the words in which short answers
come. Sources are written as `oodscen.judging.patterns` says, for normalised text: lower case,
`ß` as `ss`.
"""

from collections.abc import Mapping

from oodscen.judging.patterns import compiled, either, few

# ------------------------------------------------------------------ actions

_OBJECT = r"[^.;,\n]{0,25}?"
"""What stands between a verb and its direction: "cambiar de carril a la" izquierda."""


def _aside(german: str, french: str, spanish: str, sign: str) -> str:
    """Return how one changes to a side, given its name."""
    return either(
        rf"(?:auf|in) die {german}e (?:fahr)?spur(?: (?:zu )?(?:wechseln|fahren|ausweichen))?",
        rf"(?:nach )?{german}s? "
        r"(?:auszuweichen|ausweichen|wechseln|ausscheren|überholen|vorbeifahren)",
        rf"(?:spurwechsel|ausweichen|wechs(?:le|eln)|weiche) nach {german}s?",
        rf"(?:chang|déport|dépass|décal|pass|roul|serr|tourn)\w*{_OBJECT}\s(?:(?:à|de) )?{french}",
        rf"(?:cambi|mov|muev|gir|pas|adelant|desvi|esquiv)\w*{_OBJECT}\s{spanish}",
        rf"(?:向|往|换到|变道到|变道至|变更到|切换到){sign}(?:侧|边)?"
        r"(?:变道|换道|车道|并线|变更车道)",
        rf"{sign}(?:侧|边)?(?:变道|换道)",
        rf"{sign}(?:側)?(?:の)?(?:車線)?(?:へ|に)(?:車線)?(?:を)?(?:変更|移動|避け)",
        rf"{sign}車線変更",
    )


FOREIGN_ACTIONS: Mapping[str, str] = {
    "emergency_brake": either(
        r"\b(?:voll|not|gefahren)brems\w*",
        r"\b(?:stark|hart|scharf|kräftig|voll) (?:ab)?(?:zu)?brems\w*",
        r"\bfrein\w* (?:brusque\w*|d'urgence|(?:très )?fort|à fond|brutale\w*)",
        r"\bfren\w* (?:de emergencia|bruscamente|a fondo|fuerte\w*|en seco)",
        r"\bfrenazo",
        r"紧急(?:刹车|制动|停车)",
        r"急(?:刹车?|ブレーキ|停車|停止)",
        r"猛踩刹车",
        r"緊急(?:煞車|刹車|ブレーキ|制動|停止)",
    ),
    "stop": either(
        r"\ban(?:zu)?halten\b",
        r"\bhalte\b[^.;,\n]{0,20}\ban\b",
        r"\bstehen ?(?:zu)?bleiben\b",
        r"\bstoppen\b",
        r"\bzum stillstand\b(?: (?:kommen|bremsen))?",
        r"\b[sm]'arrête\w*|\barrêt(?:er|ez)\b|\barrêt complet\b",
        r"\bdeten(?:er\w*|ga\w*|dría)\b|\bdetén\b|\bparar(?:se|ía)?\b",
        r"停(?:车|下|住|止|車)(?!线|场|标|牌|位|線|中)",
        r"止ま(?:る|り|って)",
    ),
    "slow_down": either(
        r"\blangsamer\b(?: (?:zu )?(?:fahren|werden))?",
        r"\bverlangsam\w*",
        r"\b(?:geschwindigkeit|tempo) (?:zu )?(?:verringern|reduzieren|senken|drosseln)",
        r"\bvom gas\b(?: gehen)?",
        r"\bralenti\w*",
        r"\brédui\w+ (?:[lsm]a )?vitesse",
        r"\blever le pied",
        r"\b(?:reduc|reduz|disminu|baj|aminor)\w+ (?:(?:la|mi|su) )?(?:velocidad|marcha)",
        r"\bdesaceler\w+",
        r"\bfrenar suavemente",
        r"减速|放慢|降低车?速",
        r"減速|徐行|(?:速度|スピード)を(?:落|下)",
    ),
    "keep_speed": either(
        r"\b(?:geschwindigkeit|tempo) (?:zu )?(?:bei(?:zu)?be)?halten",
        r"\bweiter(?:zu)?fahren\b",
        r"\b(?:garder|maintenir|conserver) (?:[lsm]a )?(?:même )?vitesse",
        r"\bcontinuer\b(?: tout droit)?(?: à la même vitesse)?",
        r"\b(?:mantener|conservar|mantendría) (?:(?:la|mi|su) )?velocidad",
        r"\bseguir (?:recto|igual|adelante)",
        r"\bcontinuar\b",
        r"保持(?:当前|现有|原有?)?的?(?:车道和)?(?:车速|速度|匀速|原速)",
        r"继续(?:直行|行驶|前进)",
        r"速度を(?:維持|保)|そのまま(?:走行|直進|進)|現状維持",
    ),
    "change_lane_left": _aside("link", "gauche", "izquierd[oa]", "左"),
    "change_lane_right": _aside("recht", "droite", "derech[oa]", "右"),
    "pull_over": either(
        r"\brechts ran(?:fahren)?",
        r"\b(?:am|an den) (?:rechten )?(?:strassen|fahrbahn)?rand\b"
        r"(?: (?:fahren|(?:(?:und|zu) )?(?:an)?halten))?",
        r"\b(?:auf|an) de[nm] (?:stand|seiten)streifen\b(?: (?:und )?\w*(?:halten|fahren))?",
        r"\b(?:se (?:garer|ranger|rabattre)|s'arrêter) (?:sur|au|le) (?:(?:le|la|long) )?"
        r"(?:bas(?: |-)côté|bord|accotement|bande d'arrêt)[\w ']*",
        r"\borillarse\b",
        r"\b(?:apartarse|detenerse|parar(?:se)?) (?:a|en|al) (?:(?:la|el|un) )?"
        r"(?:lado|arc[eé]n|orilla|borde|costado)[\w ]*",
        r"靠(?:边|右)(?:停车|停下)?|路边停车|停(?:车)?(?:在|到)路(?:肩|边)",
        r"路肩に(?:寄|停)\w*",
    ),
}
"""By action id: what it is called."""

DENIAL = compiled(
    r"\b(?:nicht|kein\w*|zu spät)\b",
    r"\b(?:ne|n'\w+|pas|éviter)\b",
    r"\bevitar\b",
    r"不(?!错)|别|避免|没|無|无|ない|ません|避けるべき",
)
"""In the clause of a name it takes the name back; none of these words is English."""

CONDITION = compiled(
    r"\b(?:wenn|falls|sonst|ansonsten|sinon|sino|de lo contrario)\b",
    r"如果|否则|若|もし|場合",
)
"""Makes what a clause says hang on something."""

# ------------------------------------------------------------------ whether a scene is unusual

YES_WORD = r"ja|oui|sí|是的?|对|有|はい"
NO_WORD = r"nein|non(?!\s+[a-z])|否|不是|没有|沒有|いいえ"

USUAL = either(
    r"\bnichts (?:\w+ )?(?:ungewöhnlich|aussergewöhnlich|auffällig|besonder)\w*",
    r"\balles (?:\w+ )?(?:normal|gewöhnlich|in ordnung)\b",
    r"\bkeine (?:auffälligkeit|besonderheit|anomalie)\w*",
    r"\bnicht (?:aus?ser|un)gewöhnlich",
    r"\brien (?:de |d')(?:\w+ )?(?:inhabituel|anormal|particulier|spécial)",
    r"\btout (?:\w+ )?normal\b",
    r"\baucune anomalie",
    rf"\bnada {few(2)}(?:inusual|anormal|raro|extraño|lo común|lo normal)",
    rf"\btodo {few(2)}normal\b",
    r"\bninguna anomalía",
    r"(?:没有|沒有|无|未发现)(?:任何|什么)?(?:明显)?的?(?:异常|異常|不寻常)",
    r"一切正常",
    r"異常(?:は|が)?(?:ありません|ない|なし)|普通の|正常です",
)
"""Says that nothing is out of the ordinary."""

UNUSUAL = either(
    r"\b(?:ungewöhnlich|aussergewöhnlich|auffällig)\w*",
    r"\b(?:inhabituel|anormal)\w*",
    r"\b(?:inusual|anormal|fuera de lo común)\b",
    r"异常|不寻常|異常",
)
"""Says that something is, where nothing denies it."""

# ------------------------------------------------------------------ how an answer is given

REFUSAL = compiled(
    r"\btut mir leid\b",
    r"\b(?:kann|darf|möchte)\b[^.;\n]{0,40}\bnicht\b"
    r"[^.;\n]{0,30}\b(?:helfen|beantworten|sehen|unterstützen)",
    r"\bdésolée?\b|\bje ne (?:peux|suis) pas\b",
    r"\blo siento\b|\bno puedo\b|\bperdona\b",
    r"抱歉|对不起|對不起|无法|無法|不能(?:回答|协助|提供|帮)",
    r"申し訳|できません|お答え",
)
"""Declines to answer; looked for only where no answer is found."""

SURENESS = either(
    r"confid[ea]n[cs]e|confident|certain|sure|probability|likel|score",
    r"sicher|konfidenz",
    r"confiance|sûr",
    r"confianza|seguridad|segur|certeza",
    r"置信度|确信度|信心|把握",
    r"確信度|信頼度|確率",
)
"""Words for how sure somebody is, or how they begin."""

ANSWER = either(
    r"antwort|aktion|entscheidung|wahl",
    r"réponse|décision",
    r"respuesta|acción|opción",
    r"答案|选择|回答",
    r"答え|選択|正解|解答|選擇",
)
"""Words for what is asked for."""

IS = r"ist|est|es|是|为|は"
