"""English wordings of claims: patterns for settings, predicates and their contexts."""

import re
from typing import NamedTuple

from oodscen.data._claim import Kind


class Pattern(NamedTuple):
    """A pattern whose match makes a claim."""

    kind: Kind
    value: str
    """Empty if a group of the pattern gives the number."""
    regex: re.Pattern[str]


def _patterns(rows: str) -> tuple[Pattern, ...]:
    """Parse a table with a kind, value and pattern per line; fill in placeholders such as `{lane}` and `{ego}`."""
    found = []
    for line in filter(None, map(str.strip, rows.splitlines())):
        kind, value, regex = line.split(maxsplit=2)
        filled = (
            regex.replace("{lane}", _LANE)
            .replace("{ego}", _EGO_ITSELF)
            .replace("{own}", rf"{_EGO}['’]s")
            .replace("{n}", _NUMBER)
        )
        pattern = re.compile(rf"(?<![\w-])(?:{filled})(?![\w-])", re.IGNORECASE)
        found.append(Pattern(kind, "" if value == "-" else value, pattern))  # type: ignore[arg-type]
    return tuple(found)


_EGO = r"(?:(?:(?:the|an|your|its) )?(?:(?:user-controlled )?ego(?:[- ](?:vehicle|car|motorcycle|driver))?|hero vehicle|autonomous vehicle|automated vehicle|self-driving car|own vehicle)|(?:me|us)(?![\w-]))"
_EGO_ITSELF = rf"{_EGO}(?!['’]s|[- ](?:vehicle|car|motorcycle|driver)['’]s|(?: own| entry| driving)? (?:lane|path)\b)"
_LANE = (
    rf"(?:{_EGO}['’]s(?: own| entry| driving| original| current| very| planned)? (?:lane|path|way|side)"
    rf"|(?:the )?ego(?: own| entry)? (?:lane|path)|(?:the |its )?(?:lane|path|way) of {_EGO}|the lane (?:in which|that|used by|where) {_EGO}"
    r"|the same lane|(?:your|my|our)(?: own)? (?:lane|path|way)|(?<=vehicle in )its(?: entry| own)? lane|(?<=vehicle inside )its lane)"
)
_NUMBER = r"(two|three|four|five|six|eight|one|a single|single|[1-8])"

NUMBER_WORDS = {
    "a single": 1,
    "single": 1,
    "one": 1,
    "two": 2,
    "both": 2,
    "three": 3,
    "four": 4,
    "five": 5,
    "six": 6,
    "seven": 7,
    "eight": 8,
    "nine": 9,
    "ten": 10,
    "dozen": 12,
    "a hundred": 100,
    "one hundred": 100,
    **{
        f"{word}{more}": 10 * tens + extra
        for tens, word in enumerate(
            ("twenty", "thirty", "forty", "fifty", "sixty", "seventy", "eighty", "ninety"), 2
        )
        for more, extra in (("", 0), ("-five", 5))
    },
}

EGO = re.compile(
    rf"(?<![\w-]){_EGO}(?:['’]s)?(?![\w-])|\b(?:it|he|she|you|your|they|I|we|my|our|nobody|traffic|(?:its|their) drivers?|driver of an? (?:disabled|failed|broken-down|stranded))\b",
    re.IGNORECASE,
)
"""The ego, and pronouns that may refer to it or to anyone."""

SETTINGS = _patterns(
    r"""
    weather clear       (?:clear|fine|sunny|bright|good)(?:,? (?:and )?(?:clear|sunny|dry|bright|warm))* (?:weather|day|sky|skies|conditions|night|sunset|sunrise|morning|afternoon|evening)(?: conditions)?
    weather clear       weather is (?:fine|clear|good)|sunny|cloudless|(?:sun is (?:out|shining)|sun shines)|blue sky|(?:bright|brilliant) sunshine|dry,? clear conditions|clear,? dry day
    weather dry         (?:road|asphalt|surface|street) is (?:still |quite )?dry|(?:on|in) (?:a )?dry (?:day|weather|conditions|road)|on a [\w-]+, dry day|dry road
    weather cloudy      overcast|cloudy|(?:heavy|low|thick|dense) clouds?|(?:grey|gray|leaden) (?:sky|skies|day)|light is flat and gr[ea]y|low cloud|dull (?:day|daylight|weather|light|morning)
    weather heavy_rain  torrential(?: rain)?|(?:heavy|hard|pouring|driving|lashing|intense) rain(?:fall|y)?|(?:hard|heavily) rain(?:y|ing)|rain(?:ing|s)? heavily|downpour|cloudburst|rainstorm|pouring(?! (?:an?|the|out|into|from|over)\b)
    weather light_rain  (?:light|gentle|soft|slight) rain|drizzl(?:e|es|ing|y)|rain(?:ing|s)? lightly
    weather rain        rain(?:s|ing|y|fall)?|(?:light|steady|freezing|gentle|mid-)rainy?
    weather heavy_snow  heavy snow(?:fall)?|(?:unusually |very )?heavy snowfall|blizzard|snowstorm|snow(?:s|ing) (?:heavily|hard)|whiteout|snow (?:is )?(?:com(?:es|ing)|fall(?:s|ing)) (?:down )?(?:hard|heavily|thick(?:ly)?|fast)
    weather light_snow  light snow(?:fall)?|snow(?:s|ing) (?:gently|lightly)|snow-dusted
    weather snow        snowfall|snowing|falling snow|snowy (?:day|night|morning|evening|weather)|snow (?:is|starts|begins) (?:falling|to fall)|snow falls|snow has set in
    weather thick_fog   (?:thick|dense|heavy|impenetrable|deep)(?: [\w-]+){0,2} fog|fog (?:is )?so (?:thick|dense)|wall of fog|bank of fog|fog bank
    weather fog         fog|foggy|fog-covered|fog-shrouded
    weather mist        mist|misty|haze|hazy
    weather wet_road    (?:road|asphalt|surface|street|tarmac) is (?:still )?wet|wet (?:afternoon|day|night|morning|evening)|wet (?:road|asphalt|street|surface|tarmac|pavement|roads)|rain-slick|rain-soaked road
    weather slippery_road icy|black ice|(?:sheet|film|layer|glaze) of ice|ice-covered|frozen road|freezing rain|slippery (?:road|surface|conditions|roads)|(?:covered|buried|buries the road) (?:in|under|by|with) (?:\w+ )?(?:ice|snow)|snow-covered|packed snow
    time day            (?:broad |full |bright |dull )?daylight(?! (?:is|has) (?:almost |nearly |all but )?(?:gone|faded|fading))|(?:sun is (?:out|shining)|sun shines|blue sky|morning rush hour|in the morning|(?<!early )morning(?! light)(?! mist)|(?<!early )misty morning)|daytime|sunny|noon|midday|afternoon|by day|on an? [\w-]+(?:, [\w-]+)? day|it is an? [\w-]+(?:, [\w-]+)? day
    time night          (?:pitch|coal)[- ](?:black|dark)(?: outside)?|(?:[12]|11|12) ?(?:o'clock )?(?:at night|in the night)|(?:0?[1-4]|12)(?::\d\d)? ?a\.?m\.?|(?:10|11)(?::\d\d)? ?p\.?m\.?|night(?!['’])|night-time|nighttime|midnight|after dark|after nightfall|darkness|in the dark|dark of night
    time twilight       dusk|dawn|daybreak|twilight|sunset|sunrise|sun has (?:just )?set|fading light|half-light|daylight is (?:almost|nearly|all but) gone|early morning(?:,? barely)? light|grey of dawn|first light|day is (?:just )?breaking|barely light|nightfall|gloaming
    time low_sun        low (?:\w+ )?sun|sun (?:is |stands |hangs )?low|setting sun|rising sun|late-afternoon sun|in the evening sun|in the morning sun
    road residential    residential|neighbou?rhood|suburban|housing estate|suburb
    road urban          city(?! bus)|urban(?! (?:highway|motorway|expressway|freeway))|downtown|town centre|inner-city|avenue|boulevard
    road highway        highway(?! (?:speed|patrol|code|maintenance|authority))|motorway|freeway|expressway|autobahn
    road rural          rural|country(?:side| road| lane)|(?:curving|winding|hilly) country road|farmland
    road tunnel         tunnel
    road bridge         (?<!under a )(?<!under the )(?<!beneath a )(?:bridge|viaduct|bridge deck)
    road roundabout     roundabout|traffic circle
    road hill           hill|hilly|hilltop|uphill|downhill|crest|brow
    road t_junction     t-junction|t-intersection|t junction|three-way (?:junction|intersection)|side (?:street|road)
    road junction       junction|intersection|crossroads|t-junction|t-intersection
    road signalised     signali[sz]ed|(?:junction|intersection|crossing|crossroads) with traffic (?:lights|signals)
    road curve          curve|curves|curved|curving(?! (?:up|down))|winding|hairpin|twisty|(?:gentle|sharp|blind|tight|long|a|the) bends?(?! (?:down|over|to))
    road one_way        one-way
    road two_way        (?:in|from) (?:each|either|both) directions?|each way|two-way
    road divided        divided|dual carriageway|central reservation
    road shoulder       hard shoulder|(?:with|on|along|onto|from) (?:an? |the |its )?(?:\w+ )?shoulder(?! to)
    road level_crossing level crossing|railway crossing|railroad crossing
    road coastal        coastal|coast road|seafront
    road mountain       mountain(?! (?:of|bike|biker|bikes))|mountainous
    own_lanes -         {n} lanes? (?:in each direction|each way|in either direction|per direction|in (?:its|the ego['’]s|your|the same|this) direction)
    lanes -             {n}-lane(?! (?:\w+ )?roundabout)
    lanes -             (?:road|street|highway|motorway|avenue|way)(?: \w+)? (?:with|of) {n} lanes(?! (?:in|each|per))
    traffic none        no other (?:vehicle|vehicles|traffic|car|cars|road user|road users)(?: is| are)?(?: nearby| in sight| around| visible)?|otherwise empty|empty (?:road|street)|deserted|nobody else
    traffic dense       (?:heavy|dense|crowded|busy|high) traffic|rush[- ]hour|traffic jam|evening peak|morning peak|congested|high-traffic|busy (?:city |urban )?(?:street|road|avenue)
    ego left_lane       {ego} (?:is )?(?:travell?ing|driving|moving|drives|travels|moves|keeps|cruises|stays|is|am|are)(?: \w+){0,3} in the (?:left|leftmost|left-hand|fast|overtaking) lane
    ego right_lane      {ego} (?:is )?(?:travell?ing|driving|moving|drives|travels|moves|keeps|cruises|stays|is|am|are)(?: \w+){0,3} in the (?:right|rightmost|right-hand|slow|nearside) lane
    ego middle_lane     {ego} (?:is )?(?:travell?ing|driving|moving|drives|travels|moves|keeps|cruises|stays|is|am|are)(?: \w+){0,3} in the (?:middle|centre|center) lane
    ego turns_left      {ego} (?:is )?(?:turning|turns|makes|making|performing|performs|attempts|attempting|takes|taking|starts)(?: an?)?(?: [\w-]+)? left(?: turn)?
    ego turns_right     {ego} (?:is )?(?:turning|turns|makes|making|performing|performs|attempts|attempting|takes|taking|starts)(?: an?)?(?: [\w-]+)? right(?: turn)?
    """
)
"""Statements about weather, light, road, traffic and the ego's lane."""

PREDICATES = _patterns(
    r"""
    place in_lane       (?:in|inside|into|onto|on|across|along|over|within|occupy(?:ing)?|enter(?:s|ing)?)(?: the)?(?: very)?(?: middle| centre| center| right edge| asphalt| surface| tarmac)?(?: of)? {lane}
    place in_lane       (?:block(?:s|ing)?|fill(?:s|ing)?|occup(?:ies|ying)|obstruct(?:s|ing)?|take up|takes up|closes|closing|cover(?:s|ing)|cross(?:es|ing)?|straddl(?:es|ing)|hold(?:s|ing)|share(?:s)?)(?: up)?(?: (?:half|part|most|the middle|the whole|all|the centre|both) of)? {lane}
    place in_lane       (?:block|obstruct)(?:s|ing) its lane|right in {own} path|in line with {ego}
    place clear_of_lane (?:just )?clear of (?:{lane}|the (?:lane|road|carriageway))|(?<!half )beside (?:the (?:road|carriageway|lane)|{lane})|short of {lane}
    place clear_of_lane (?<!half )on the (?:hard |gravel |grass |right |left |right-hand |left-hand |nearside |far )*(?:shoulder|verge|pavement|sidewalk|kerb|curb|roadside)|at the (?:roadside|kerb|curb)
    place left          (?:on|at) (?:the|{own}) left(?:-hand (?:side|kerb|verge|edge))?(?! lane)|left of {ego}|on the left front
    place right         (?:on|at) (?:the|{own}) right(?:-hand (?:side|kerb|verge|edge))?(?! lane)|right of {ego}|on the right front
    place left_lane     in the (?:next |adjacent |neighbou?ring )?lane (?:to|on) (?:its|the|{own}) left|in the next lane on the left|(?:stand|li|sit|park|stop|drive|travel|wait|crash)\w* (?:\w+ )?in the left lane|(?:in|from) the lane (?:to|on) the left|(?:in|from) the (?:left neighbou?ring|adjacent left|neighbou?ring left|left-hand) lane
    place right_lane    in the (?:next |adjacent |neighbou?ring )?lane (?:to|on) (?:its|the|{own}) right|in the next lane on the right|(?:stand|li|sit|park|stop|drive|travel|wait|crash)\w* (?:\w+ )?in the right lane|(?:in|from) the lane (?:to|on) the right|(?:in|from) the (?:right neighbou?ring|adjacent right|neighbou?ring right|right-hand) lane
    place oncoming_lane (?:in|on|into|across|onto|block(?:s|ing)|occup(?:ies|ying)|fill(?:s|ing)) the (?:oncoming|opposite) (?:lane|carriageway|side)
    place behind        (?:(?:close|right|just|directly|immediately|closely|short distance) )?behind {ego}|(?:close|right|just|closely|directly) behind it|(?:close|right|closely) behind|following (?:closely|close)|follows (?:closely|close)|tailgat(?:es|ing)|(?:up )?from behind(?! (?:an?|the|it|its|some|two|parked)\b)
    place ahead         ahead(?! of (?!{ego}|it\b))|(?:\d+|a few|some) ?(?:m|metres|meters) (?:further on|down the road)|(?:a little|some) way (?:further )?(?:on|down the road)|a short distance (?:further on|down the road)|(?:comes|come|came|coming) into view|in front(?! of)|in front of {ego}|before {ego}
    distance -          (\d{1,3}|(?:twenty|thirty|forty|fifty|sixty|seventy|eighty|ninety)(?:-five)?|(?:a|one) hundred) ?(?:m|metres|meters)(?: \w+)? (?:ahead|in front|away|from|down|up|before|further|on)
    motion stationary   stands?|remain(?:s|ing)? (?:standing|lying|in place|at rest)|rested|(?:has|have) (?:(?:been|just|already) ){0,2}(?:left standing|placed|put up|put in place|set up|set down|parked|erected|positioned|collapsed|fallen asleep)|(?:is|are|been) (?:now )?(?:placed|scattered|heaped|wedged|jammed|lodged|planted|set up|put up|laid|abandoned|left)|are (?:strewn|spread)|(?:left|dumped|tipped|deposited|unloaded|abandoned) (?:\w+ )?(?:in|on|across|beside|at|inside)|and (?:has )?stopped(?= (?:in|on|across|dead|there))|slid to a (?:halt|stop|standstill)|onto its (?:roof|side)|on its (?:roof|side)|upside down|stays (?:there|on all fours|where|put)|(?:has|have) derailed|asleep|on the ground|flat on (?:the|its|his|her)|face down|gap(?:es|ing)|sitting|rises from the|leave (?:their|his|her|its) [\w-]+ (?:in|on|at)|(?<!was )(?<!were )standing|lie(?:s)?|lying|lay(?:s)?|sit(?:s|ting)?|parked|stationary|motionless|immobile|has stopped|have stopped|is stopped|halted|has broken down|stalled|stranded|abandoned|dumped|left standing|come to (?:a |an )?(?:\w+ )?(?:rest|standstill|stop|halt)|came to rest|at a standstill|stuck|positioned(?! behind)|has died|will not start
    motion moving       race (?:over|across|past|towards)|approach(?! to\b| road)|meander(?:s|ing)?|wobbl(?:es|ing)|veer(?:s|ing)?|slew(?:s|ing)|rumbl(?:es|ing)|mak(?:e|es|ing) (?:his|her|its|their) way|at a gallop|push(?:es|ing) (?:an?|the|his|her)|follows the|(?:takes|uses) the (?:junction|full width|whole width)|(?:is|are) ridden|(?:turned|heading) (?:round|back)|rolls? along|on (?:its|their) way|dawdl(?:es|ing)|inch(?:es|ing) (?:forward|along|back|ahead)|ambl(?:es|ing)|proceed(?:s|ing)|trundl(?:es|ing)|waddl(?:es|ing)|scurr(?:y|ies|ying)|weave|squeez(?:es|ing) past|aims for|sail(?:s|ing) (?:into|across|past|out|through)|burst(?:s|ing) (?:out|from|through)|keeps astride|goes along|zigzag(?:s|ging)?|mak(?:e|es|ing) for {ego}|(?:has|have) (?:dodged|swerved|veered|switched|pulled out)|follows an? zigzag|turns? round|at a run|pushes forward|chats from wheel|com(?:e|es|ing) (?:round|down|over)|goes first|spinning|form(?:s|ing)? a (?:rolling|moving) roadblock|snak(?:es|ing)|(?:avoids|evades)|tak(?:es|ing) the right of way|leav(?:es|ing) {lane}(?! (?:passable|open|free|clear|usable|empty))|us(?:es|ing) {lane} as|keeps (?:inside|to|in) the|to keep (?:upright|its balance)|(?:has|have) (?:begun|started) to (?!burn)\w+|com(?:e|es|ing) (?:off|towards|along)|(?:drive|travel|move|ride|roll) (?:abreast|out|side by side|slowly|along|at|in|on(?:wards?)?|past|with|down|up)|walk (?:along|across|in|on|down|up|out|over|past|through|towards|straight|crabwise|around|about|between|slowly|from)|run (?:across|into|onto|out|along|through|over|in front|towards|past|straight|side|about|around)|(?:mill|mov|wander|stroll|pac|limp|hobbl)(?:e|es|s|ing)? (?:about|around|along|slowly|aimlessly|to and fro)|advanc(?:e|es|ing)|strid(?:e|es|ing)|stroll(?:s|ing)?|sway(?:s|ing)|swing(?:s|ing)(?! (?:bridge|door|doors))|lurch(?:es|ing)|coast(?:s|ing) (?:to|along|down|out)|stagger(?:s|ing)|stumbl(?:es|ing)|hobbl(?:es|ing)|skat(?:es|ing)|slid(?:es|ing)|skid(?:s|ding)|slip(?:s|ping) (?:into|out|past|through)|tumbl(?:es|ing)|bounc(?:es|ing)|bowl(?:s|ing)|blow(?:s|ing) (?:across|over|along|into|past)|flutter(?:s|ing)|fl(?:ies|ying)|hover(?:s|ing)|dodg(?:es|ing)|rac(?:es|ing)|speed(?:s|ing)|shoot(?:s|ing) (?:out|across|past)|hurtl(?:es|ing)|charg(?:es|ing)|spring(?:s|ing) (?:into|out|onto|in|across|from)|march(?:es|ing)|parad(?:es|ing)|graz(?:es|ing) (?:along|its)|turn(?:s|ing) (?:slowly|out|into|across|off|onto)|pull(?:s|ing) (?:level|away|off|into|onto|across)|mov(?:e|es|ing) (?:off|out|over|up|on)|set(?:s|ting) (?:off|out|foot)|start(?:s|ing) (?:across|out|off|to (?:cross|walk|run|move|drive|roll))|begin(?:s|ning)? to (?:cross|walk|run|move|drive|roll|swing|sway|reverse)|break(?:s|ing) out|com(?:es|ing) (?:out|rolling|running|walking|flying|bouncing|racing|up)|head(?:s|ing) (?:straight|for|towards|across|down)|tak(?:e|es|ing) the (?:direct|shortest) (?:way|line|route)|leav(?:es|ing) (?:the|its|a) (?:cones|kerb|pavement|forecourt|parking space|verge)|steer(?:s|ing) (?:away|into|onto|across|left|right|out)|driv(?:es|ing)(?! (?:policy|behavio\w+|conditions|style))|mov(?:es|ing)(?! house)|travel(?:s|ling|ing)|rid(?:es|ing)|runs?|running(?! (?:lane|to the|along the))|walk(?:s|ing)?|wander(?:s|ing)?|roam(?:s|ing)?|roll(?:s|ing)|creep(?:s|ing)?|crawl(?:s|ing)?|trot(?:s|ting)?|gallop(?:s|ing)?|jog(?:s|ging)?|sprint(?:s|ing)?|dash(?:es|ing)|dart(?:s|ing)|leap(?:s|ing)?|bound(?:s|ing)|jump(?:s|ing)?|hop(?:s|ping)|swerv(?:es|ing)|weav(?:es|ing)|overtak(?:es|ing(?! lane))|merg(?:es|ing)|drift(?:s|ing)|stray(?:s|ing)?|pedals?|pedalling|limps|approach(?:es|ing)|revers(?:es|ing)|pull(?:s|ing) out|cut(?:s|ting) in|cut(?:s|ting) off|step(?:s|ping) (?:out|onto|into|off)|emerg(?:es|ing) from
    motion slow         slow cordon|far below the (?:speed limit|limit|speed of)|far slower than|dawdl(?:es|ing)|inch(?:es|ing) (?:forward|along)|at a fraction of (?:its|the|{own}) speed|at low speed|at (?:a )?walking (?:pace|speed)|(?:driv|mov|travel|roll)(?:es|s|ing|ling)? (?:very )?(?:slowly|along slowly)|slow(?:ly)?[- ]moving|slowly moving|creep(?:s|ing)?(?: along)?|crawl(?:s|ing)?|at (?:a |less than )?walking pace|slowed to (?:a crawl|walking pace)|drops? to a crawl|plods?(?: along)?
    motion oncoming     against the flow|against traffic|(?:heading|drives|driving|comes|coming) back along|oncoming|towards us|(?:in|from) the opposite direction|us(?:es|ing) {lane} in the opposite direction|wrong side of the road(?! (?:of|works))|(?:straight|directly|right) for {ego}|towards? {ego}|towards it|(?:pedals|drives|comes|coming|rides|runs|running|charges|heads|heading|races|racing|hurtles|speeds|trots|gallops|straight|directly|right) at {ego}|head-on|against (?:the )?(?:flow of )?(?:traffic|its direction|the direction of travel)|(?:the|in the) wrong (?:way(?! (?:round(?! the)|up))|direction)|(?:driv|rid|travel|com|pedal|mov)\w+ (?:[\w'-]+ ){0,4}on the wrong side|com(?:es|ing) the other way|com(?:es|ing) from the opposite direction|approaching in the (?:oncoming|opposite) lane
    motion crossing     sets? (?:off|out) across|lead(?:s|ing) (?:[\w-]+ ){1,4}across|starts? across|cross(?:es|ing)?(?! the (?:marking|line|centre|center|verge|median))(?!,? with traffic)(?! ahead|[- ]?traffic|[- ]?wind|[- ]?roads?|[- ]?section|-)|(?:bowls|bounces|blows|flies|trots|charges|gallops|hops|skates|races|rushes|moves|blown|rolling|jumps|flits|scurries) (?:right |straight |suddenly )?(?:across|over the (?:road|carriageway|street|roadway))|(?:direct|shortest) (?:way|line|route) (?:over|across)|(?:run|runs|running|walk|walks|walking|dash|dashes|dart|darts|drive|drives|shoot|shoots|leap|leaps|bolt|bolts|roll|rolls|step|steps|wander|wanders|ride|rides|stroll|strolls|hurry|hurries) (?:out )?(?:straight |right |suddenly |blindly )?across
    motion crossing     (?:runs|running|darts|darting|dashes|dashing|leaps|leaping|bolts|bolting|sprints|jumps|bounds|steps|stepping|shoots) (?:straight |suddenly |blindly |right )?(?:out|into|onto|on to|in front|off)
    motion from_left    (?:from|leaves|out of|off|down) (?:behind |between |under )?(?:an?|the|some|two|parked|its) (?:[\w-]+ ){1,3}(?:on|at) (?:the|its|{own}) left(?:-hand)?(?: (?:side|kerb|verge|edge))?|between (?:[\w-]+ ){1,4}(?:on|at) the left(?:-hand)?(?: (?:side|kerb|verge|edge))?|from left to right|from the left-hand (?:kerb|edge|pavement)|(?:out )?(?:from|of) (?:(?:the|its|{own}) )?left(?:-hand (?:side|verge|edge|kerb))?(?: front)?|from the left-hand (?:side|verge)
    motion from_right   (?:from|leaves|out of|off|down) (?:behind |between |under )?(?:an?|the|some|two|parked|its) (?:[\w-]+ ){1,3}(?:on|at) (?:the|its|{own}) right(?:-hand)?(?: (?:side|kerb|verge|edge))?|between (?:[\w-]+ ){1,4}(?:on|at) the right(?:-hand)?(?: (?:side|kerb|verge|edge))?|from right to left|from the right-hand (?:kerb|edge|pavement)|(?:out )?(?:from|of) (?:(?:the|its|{own}) )?right(?:-hand (?:side|verge|edge|kerb))?(?: front)?|from the right-hand (?:side|verge)
    motion into_lane    performs? a cut-in|(?:drag|switch|slew|skid|spin|bounc|slip|cut|swerv|chang|mov|merg|drift|stray|pull|steer|nos|push|stepp?|runn?|walk|roll|jump|leap|dart|shoot|com|veer|slid|lurch)(?:s|es|ing)?(?: (?!back)[\w-]+){0,4} into {lane}|cut(?:s|ting) in(?! half| two| on)
    motion reversing    revers(?:es|ing)|(?<!look )(?<!looks )(?<!looking )(?<!facing )backwards|back(?:s|ing) (?:out|up)|tail first|in reverse
    motion braking      (?:keeps|goes on) (?:stalling|stopping|braking)|loses drive|breaks down in motion|slows(?! (?:all|every|the|traffic|down the))|comes to (?:a )?(?:rest|standstill)|its speed falls away|rolls? to a (?:stop|halt)|coasts? to a (?:stop|halt)|halts (?:again|and|once)|alternately accelerates and (?:stops|brakes)|(?<!the )(?<!its )(?<!failed )(?<!no )(?<!without )brak(?:es|ing)|(?:an? )?emergency stop|(?:decelerates )?at full braking|speed to zero|comes to an? (?:[\w-]+ )?(?:halt|stop)|halts (?:[\w-]+ ){0,3}to let|slams on (?:its|the) brakes|decelerat(?:es|ing)|slows down|(?:suddenly|abruptly) (?:stops|slows)|stops (?:suddenly|abruptly|dead)|comes to a (?:sudden |dead |complete )?(?:halt|stop)
    state off           unlit|without (?:any )?lights|with no lights|(?:all )?its lights off|lights switched off|has no lights|no tail lamps|put out every lamp|without (?:head|tail)(?:lights|lamps)
    state hazard        hazard (?:lights|lamps|warning lights|flashers)(?: (?:on|flashing|blinking))?|four-way flashers
    state beacon        (?:its |with )?(?:siren|blue lights|beacon)s?(?: (?:on|flashing|flickering|flicker|flashes))?
    """
)
"""Statements about things, after the thing or right before it."""

SIGNALS = _patterns(
    r"""
    state off           (?:gone|went|go|are|is|stay|every \w+ \w+) dark|go(?:es)? out|gone out|(?<!controller )(?:has|have) failed|fail|failing|out of (?:order|action|service)|without power|non-functional|not working|dead
    state all_on        all (?:three |its |their )?colours|red, amber and green|red and green|red and green glow together
    state red           (?:is|shows|turns|showing|stays) red
    state green         (?:is|shows|turns|showing|stays) green
    state flashing      flash(?:es|ing) amber|amber (?:is )?flashing|blink(?:s|ing) amber
    """
)
"""Statements that apply only to signals."""

LEADS = _patterns(
    r"""
    motion stationary   stationary|immobile|disabled|parked|double-parked|stopped|halted|motionless|standing|abandoned|stranded|broken-down|stalled|crashed|wrecked|overturned|fallen|downed|uprooted
    motion slow         slow cordon|far below the (?:speed limit|limit|speed of)|far slower than|dawdl(?:es|ing)|inch(?:es|ing) (?:forward|along)|at a fraction of (?:its|the|{own}) speed|at low speed|at (?:a )?walking (?:pace|speed)|slow|slow-moving|slowly moving|crawling|creeping
    motion moving       slower|snaking|swaying|swinging|weaving|speeding|moving|slowly moving|slow-moving|running|galloping|rolling|reversing
    motion oncoming     against the flow|against traffic|(?:heading|drives|driving|comes|coming) back along|oncoming|towards us|(?:in|from) the opposite direction|us(?:es|ing) {lane} in the opposite direction|wrong side of the road(?! (?:of|works))|(?:straight|directly|right) for {ego}|approaching|wrong-way
    motion reversing    reversing
    motion crossing     crossing
    state off           unlit|unlighted
    """
)
"""Adjectives right before a noun."""

FORBIDDEN = re.compile(
    r"(?:(?<!starts )(?<!begins )(?<!began )(?<!starting )(?<!beginning )\bto|will|would|could|may|might|(?<!fuel )(?<!petrol )can|cannot|must|should|went|not|never|nearly|almost|without|instead of|before|no longer|how to|"
    r"although no|no|do not|does not|which would)\s(?:\w+ )?$"
    r"|\b(?:an?|the|its|their|his|her|whose|for)\s$|\buntil (?:\w+ ){0,2}$|\b(?:look|star|fac|gaz|point|signal|gestur|wav)\w*(?: \w+)? $",
    re.IGNORECASE,
)
"""Words before a verb that mean that it does not happen, or not yet."""

NOT_THERE = re.compile(
    r"(?:\b(?:no|without|neither|nor|than|like|resembl\w+|instead of|rather than|mistaken for|seems? to be|appears? to be|loose from|not|any|every|all|other|each|fellow|lack of|absence of|size of|shape of|sound of|smell of|as [\w-]+ as|"
    r"(?:reserved|meant|space|room|place|made|designed|built|enough|sign|parking) for|ignor\w+|aimed at)\s+(?:(?:an?|the|any|other)\s+)?(?:[\w-]+\s+){0,2}"
    r"|\b(?:lost|fell|fallen|falls|falling|come loose|come|let go|strewn|toppled|dropped|shed|slid|slipped|torn(?! off)|spilled|spilt|blown|thrown|left behind|came|rolled|bounced)\b[^.;,]{0,25}\b(?:from|off|by)\s+(?:(?:an?|the|some|passing)\s+)?(?:[\w'-]+\s+){0,2}"
    r"|\bto (?!an?\s|the\s|its\s|one\s|their\s|leave\s|abandon\s|find\s|see\s)\w+ (?:an? |the )?(?:[\w-]+ )?"
    r"|\b(?:crates?|logs?|boxes|load|planks|pipes|goods|cargo|timber) from an? (?:[\w-]+ ){0,2}|\bbecause of [^.,;]{0,40}|\b(?:gives?|shows?) the (?:[\w-]+ )?|\b(?:speed|pace|height|width) of an? (?:[\w-]+ )?"
    r"|\bso that |\bshoulder is [^.;,]{0,30}|\b(?:said|says|sign|board|warning|warns|warn) (?:of|about) (?:[\w-]+\s+){0,2})$",
    re.IGNORECASE,
)
"""Words before a noun that mean that the thing is absent."""

RIDES = re.compile(
    r"^ (?:on|astride) (?:an?|his|her) (?:[\w-]+ )?(?:bike|bicycle|e-scooter|scooter|motorcycle|motorbike|moped|horse|tractor)",
    re.IGNORECASE,
)
"""Words after a person that mean a rider."""

UNSHOWN = re.compile(
    r"\b(?:without|no|not|nor|neither|instead of)\s(?:[\w-]+ ){0,3}$", re.IGNORECASE
)
"""Words before lights that mean that they are not lit."""

PAST = re.compile(r"\bafter (?:the |an? |heavy |long )?(?:[\w-]+ )?$", re.IGNORECASE)
"""Words before weather that mean that it is over."""

ENDED = re.compile(
    r"^ (?:\w+ )?(?:has|have|had) (?:just |finally |already |now )?(?:stopped|ceased|ended|passed|lifted|cleared|gone|let up)"
    r"|^ (?:stopped|ceased|is over|earlier|of the (?:night|day) before|warning|forecast|tyres?|coat|boots)\b",
    re.IGNORECASE,
)
"""Words after weather that mean that it is over, or not literal."""

NEGATED = re.compile(
    r"\b(?:not(?! far\b)|never|without|no|nor|hardly|barely|scarcely|instead of)\s(?:\w+ )?$",
    re.IGNORECASE,
)
PERFECT = re.compile(r"\b(?:has|have|had)\s$", re.IGNORECASE)

NOT_ITSELF = re.compile(
    r"^(?:['’]s? | of (?:drinks|goods|tools|beer|water|fruit)\b|,? (?:that |which )?(?:has|have|had)(?: just)? (?:lost(?! (?:a wheel|control|grip))|dropped(?! (?:out|from|by|onto|into|down))|shed|spilled(?! (?:over|from|out|off))|spilt|carried|pulled down|torn down|brought down|knocked down|dumped|put up|set up|run into)(?! its (?!load|cargo))| (?:is|are|was|were) (?:not|never|nowhere|rarely)\b| of (?:farm|fire|parked|tractors|people|vehicles|light|sound)\b|[ -](?:costume|park|stop|lane|driver|drivers|wash|length|lengths|horn|tracks?|tyres?|load|cargo|parts?|part|sized|like|shaped|owner|show|dealer|race(?! over| across| past| towards| into)|alarm|company|number|traffic|count|behavio\w+|dynamics|collision|fence|market|crossing|crossings|lines?|flow|transport|machinery|track)\b)",
    re.IGNORECASE,
)
"""Words after a noun that show that it only modifies another."""

DENIED = re.compile(
    r"\b(?:no|without|not|between|nor|than|any|disused|former|leaves? the|after an?|last|yesterday's|during the|all) (?:[\w-]+ )?$",
    re.IGNORECASE,
)
"""Words before weather or a road that negate it."""

CARRIED = re.compile(r"\bwith (?:an? |its |two |some )?(?:[\w-]+ ){0,2}$", re.IGNORECASE)
"""Words between two things that make the second a part or the load of the first."""

QUANTITY = re.compile(
    r"\b(?:(two|both|three|four|five|six|seven|eight|nine|ten|\d{1,3}(?! ?m(?:et(?:re|er)s)?\b))|(a (?:pair|couple) of)|((?:a |an )?(?:\w+ )?(?:row|line|group|crowd|herd|flock|cluster|string|number|pack|swarm|handful) of|several|a few|some|many|multiple|dozens of|various))\s+(?:[\w'’-]+,?\s+){0,3}$",
    re.IGNORECASE,
)

DETERMINER = re.compile(
    r"\b(another|a second|a third|a further|an?|the|its|his|her|their|this|that|these|those|one)\s+(?:(?!(?:an?|the|another|its|their)\s)[\w'’-]+,?\s+){0,3}$",
    re.IGNORECASE,
)

BACKGROUND = re.compile(
    r"\b(?:among|amid|between|behind|beneath|past|through|under|with|lined by|shaded by) (?:the )?(?:(?!fallen|felled|uprooted)[\w-]+ )?$",
    re.IGNORECASE,
)
"""Words before trees that place them beside the road."""

OBLIQUE = re.compile(
    r"\b(?:from|behind|between|beneath|under|near|beside|past|round|around|of|over|in front of|on|at|towards?|against|through|into|onto|off|among|amid|next to|to|in|up to|before|for|by|out of|along|across|than|as)"
    r"\s+(?:(?:an?|the|its|his|their|one|two|three|some|several|both|parked)\s+)?(?:(?!(?:an?|the|its|his|their|this|that|two|three|another)\s)[\w'’-]+\s+){0,2}$",
    re.IGNORECASE,
)
"""Prepositions before a noun phrase, which therefore is not a subject."""

BREAK = re.compile(
    r"[.;:!?]+(?=\s|$)|,\s|\s[-–—]\s|\s(?=(?:and|but|while|whilst|when|as|whose|which|that|who|where|with|although|though|so|until|because|before|after|since|if|yet)\s)"
)
RELATIVE = re.compile(r"^(?:which|that|who|whose)\s", re.IGNORECASE)
SENTENCE = re.compile(r"[.;!?]+(?=\s|$)")

BLOCKED_BY = re.compile(
    rf"(?:{_LANE}) (?:is|has been|ends|lies|closed|blocked) (?:[\w-]+ ){{0,2}}?(?:blocked|barred|taken|taken up|closed|occupied|obstructed|filled|cut off|covered)(?: [\w-]+){{0,6}}? (?:by|with) ",
    re.IGNORECASE,
)
"""Statements that the ego's lane is blocked by the thing that follows."""

LIGHT = frozenset(
    {
        "traffic light",
        "pedestrian signal",
        "balloon",
        "plastic bag",
        "tumbleweed",
        "drone",
        "smoke",
        "ball",
        "object",
    }
)
"""Things that rarely stay in place, and signals, which do not move anyway."""

PARTS = frozenset({"tyre", "bumper", "car door"})
"""Things that become a vehicle's part after a definite article."""

INERT = frozenset(
    {
        "barrier",
        "traffic cone",
        "traffic light",
        "tree",
        "power pole",
        "power line",
        "smoke",
        "bonfire",
        "flood water",
        "puddle",
        "oil spill",
        "broken glass",
    }
)
"""Things whose only claimed motion is falling, rolling and the like."""

LEFT = re.compile(
    r"\b(?:leav(?:es|ing)|left|from|off|out of|was|were|had)\s(?:[\w'-]+\s){0,4}$", re.IGNORECASE
)
"""Words before a place that mean that the thing is no longer there."""

GENERIC = frozenset({"vehicle", "object", "person", "animal", "heavy vehicle", "heavy equipment"})
"""Names that may refer to a thing named before."""

BLOCKED = re.compile(
    r"\b(?:closed|closes|blocked|barred|shut(?: off)?|occupied|obstructed|cut off|littered|strewn|marked)\b[^.;]{0,50}\b(?:by|with) (?:[\w-]+ ){0,5}$"
    r"|\bends\b[^.;]{0,40}\bat (?:the (?:rear|back|tail) of )?(?:[\w-]+ ){0,4}$",
    re.IGNORECASE,
)
"""Words before a noun that mean that it blocks the way."""

PUT = re.compile(
    r"\b(?:parked|abandoned|positioned|placed|dumped|leave|unloaded|tipped|erected|put up|set up|scattered|left) "
    r"(?:(?:an?|the|their|his|her|its|some|two|three|several|down) )?(?:[\w-]+ ){0,4}$",
    re.IGNORECASE,
)
"""Words before a noun that mean that someone put it there."""

BORNE = re.compile(
    r"\b(?:with|holding|pushing|pulling|carrying|wheeling|dragging|balancing|towing|drags?|pushes|pulls|carr(?:y|ies)|wheels?) "
    r"(?:(?:an?|the|their|his|her|its|some|two|three|several) )?(?:[\w-]+ ){0,4}$",
    re.IGNORECASE,
)
"""Words before a noun that mean that someone moves it."""

AGENT = re.compile(
    r"^(?: moving house)? (?:has|have|had) (?:just |already |also )?"
    r"(?!(?:collapsed|fallen|stopped|halted|come|gone|broken|stepped|walked|put themselves|stationed themselves|dropped out|run|started|begun|slowed|"
    r"spilled over|sat|lain|knelt|wandered|strayed|lost (?:his|her|their|its)|taken|moved|got|been|had)\b)[\w-]+ "
    r"(?:up |down |over |out )?(?:fire to |an? |the |two |some |several |their |his |her |its )?[\w-]+",
    re.IGNORECASE,
)
"""Words after an agent that report a past action; the agent may be gone."""

ROADWAY = re.compile(
    r"\b(?:junction|intersection|crossing|crossroads|crosswalk|curve|bend|turn|exit|ramp|tunnel|bridge|roundabout|"
    r"hill|stop line|merge|interchange|toll|station)\b",
    re.IGNORECASE,
)
"""Parts of the road that may be ahead but are not things."""

BARS = re.compile(
    r"(?<![\w-])(?:forms an? (?:unmarked |misplaced )?(?:construction|obstacle|barrier|barricade)|block(?:s|ing)?|bar(?:s|ring)|shut(?:s|ting)?|obstruct(?:s|ing)?|occup(?:ies|ying|y)|broadside|in flames|on fire|ablaze|burning|"
    r"(?:has|have) (?:been )?(?:flipped|overturned|toppled|ended up|jackknifed|crashed|tipped over))(?![\w-])",
    re.IGNORECASE,
)
"""Words that keep a vehicle without another motion in place."""

BLOCKS = re.compile(
    r"(?<![\w-])(?:block(?:s|ing)?|bar(?:s|ring)|shut(?:s|ting)?(?: off)?|clos(?:es|ing)|obstruct(?:s|ing)?|occup(?:ies|ying|y)|"
    r"fill(?:s|ing)?|cover(?:s|ing)?|take(?:s)? up|litter(?:s|ing)?|lean(?:s|ing)?|stretch(?:es|ing)?|form(?:s|ing)?|scattered|strewn|set up|force(?:s)? traffic|taper(?:s|ing)|leads? (?:out|up)|"
    r"(?:stick|jut|hang|spill|reach)(?:s|es|ing)? (?:out |down )?(?:into|over|across|onto)|broadside|in flames|on fire|ablaze|blazing|(?:is|are) burning|burns?|"
    r"(?:has|have) (?:been |just )?(?:tipped|fallen|toppled|rolled|come down|slid|spread|flipped|overturned|broken up|caved in|run out|leaked|landed|ended up|"
    r"left|dumped|blown over|pushed|shifted|moved|tipped over|knocked over|shed|thrown|brought)|sways? (?:gently )?in)(?![\w-])",
    re.IGNORECASE,
)
"""Words that keep an inanimate thing in place."""

STIRS = re.compile(
    r"\b(?:roll(?:s|ing)|slid(?:es|ing)|bounc(?:es|ing)|tumbl(?:es|ing)|blow(?:s|ing)|fl(?:ies|ying)|fall(?:s|ing)|drift(?:s|ing)|skid(?:s|ding)|"
    r"spin(?:s|ning)|hop(?:s|ping)|swing(?:s|ing)|topples|toppling|float(?:s|ing)|drop(?:s|ping)|hover(?:s|ing)|carr(?:y|ies|ying)|(?:is|are|being) (?:carried|pushed|pulled|towed|dragged|blown|washed)|"
    r"drag(?:s|ging)|push(?:es|ing)|pull(?:s|ing)|towed|towing|across in front|com(?:es?|ing) (?:off|down|over|out|from|across|rolling)|goes|sheds|throws|cross(?:es|ing)|mov(?:es|ing)|driven by|held|between them)\b",
    re.IGNORECASE,
)
"""Words that may set an inanimate thing in motion, in the sentence that names it."""

GENERIC_WORDS = GENERIC | {
    "people",
    "pedestrian",
    "man",
    "woman",
    "figure",
    "walker",
    "obstacle",
    "heavy machine",
    "machine",
}
"""Words, these names included, that may refer to a thing named before."""

CYCLES = frozenset({"cyclist", "bicycle", "cargo bike", "e-scooter"})
"""Road users that are never called `the vehicle`."""

BY_NATURE = {
    "wrong-way driver": "oncoming",
    "ghost driver": "oncoming",
    "peloton": "moving",
    "bunch of riders": "moving",
    "march": "moving",
    "parade": "moving",
    "procession": "moving",
    "jogger": "moving",
    "runner": "moving",
}
"""Motion implied by a name, if the text says nothing else about it."""

STILL_BY_NAME = re.compile(
    r"\b(?:fallen|toppled|uprooted|felled|fell|came down|parked|on the ground|burnt-out|burned-out|wrecked|overturned|flipped|upturned)\b"
)
"""Names of things that do not move."""

MOVED_PAST = re.compile(
    rf"\b{_EGO}(?:['’]s)? (?:is |are |am )?\w+|\b(?:dusk|night|darkness|snow|rain|drizzle)\b[^.;,]{{0,12}}\b(?:falling|falls)"
    r"|\bfalling (?:snow|rain)|\bsmoke (?:\w+ ){0,2}?\w+s\b|\b(?:light|heavy) snow falling",
    re.IGNORECASE,
)
"""Motions in a sentence that do not belong to a thing."""

PART_OF = re.compile(
    r"(?:^|[.;,] |\b(?:and|when|while|as|but|then) )(?:the|an?|its) "
    r"(?!(?:side|edge|middle|end|front|lane|path|group|row|line|crowd|shape|size|sound|back|sign)\b)[\w-]+ of (?:an?|the) (?:[\w-]+ ){0,2}$",
    re.IGNORECASE,
)
"""Words before a noun that open a clause with its part or driver; the clause then describes the noun."""

ON_FOOT = re.compile(
    r"(?:walk|strid|stroll|step|hurr|stagger|stumbl|hobbl|march)\w*", re.IGNORECASE
)
"""Verbs for people on foot."""

ITS = re.compile(r"\b(?:its|their|his|her) (?:[\w-]+ )?$", re.IGNORECASE)
"""Possessives before a noun that make it a part of something."""

STRIDES = re.compile(r"(?:walk|strid|stroll|stagger|hobbl)\w*", re.IGNORECASE)
"""Verbs that never apply to vehicles."""

LIES = re.compile(
    r"\b(?:lies?|lying|stands?|sits?|blocks?|come to (?:rest|a stop)|dumped|piled up|left)\b"
)
"""Words that assert a presence, even if the name of the thing is unknown."""

OF_ITS_VEHICLE = re.compile(r"^ of (?:an?|the|its) ", re.IGNORECASE)
"""Words after a driver that introduce the vehicle."""

BEING = re.compile(r"\b(?:is|was|were|are|been|be) $", re.IGNORECASE)
"""Forms of `be` right before a noun, which mean that the word is an adjective."""

LEAVES = re.compile(r"(?:merg|pull|cut|mov|steer|swerv|drift)\w*", re.IGNORECASE)
"""Verbs that may take a vehicle from the roadside into the lane."""

LACKED = re.compile(r"\b(?:without|neither|nor|no)\b[^,.]{0,20}$", re.IGNORECASE)
"""Words before a noun that deny it to something named earlier."""
