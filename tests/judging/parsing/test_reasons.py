"""Reasons beside an answer make it unreadable only if they deny or condemn its action.

`{0}` stands for the action, `{1}` for its gerund.
"""

import json
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.judging._parsing import read_action, read_choice

NAMES = {
    "stop": ("stop", "stopping"),
    "slow_down": ("slow down", "slowing down"),
    "keep_speed": ("keep the speed", "keeping the speed"),
    "emergency_brake": ("brake hard", "braking hard"),
    "change_lane_left": ("change to the left lane", "changing to the left lane"),
    "change_lane_right": ("change lanes to the right", "changing lanes to the right"),
    "pull_over": ("pull over", "pulling over"),
}
SUPPORTING = """
Not pulling over or {1} invites trouble.|It would be unsafe not to {0}.|It would be dangerous not to {0} here.|Failing to {0} could cause a collision.|Failing to {0} would be dangerous.
Not {1} would be reckless.|Not {1} risks a collision.|There is no option but to {0}.|We cannot do anything but {0}.|I see no alternative to {1}.
Nothing but {1} is safe.|The collision cannot be avoided without {1}.|Without {1}, the ego would hit the tree.|We will crash unless we {0}.
If we do not {0}, we will crash.|If the ego does not {0}, it is not safe.|It is not safe to do anything other than {0}.
It would be a mistake not to {0}.|We must not fail to {0}.|I cannot recommend anything except to {0}.|It is too dangerous to do anything but {0}.
There is nothing wrong with {1}.|{1} is not dangerous here.|{1} is not a problem, as nobody follows.|It is not unsafe to {0}.
There is no reason not to {0}.|Nothing prevents us from {1}.|No vehicle stops the ego from {1}.|Do not hesitate to {0}.|It is never wrong to {0} here.
{1} does not endanger anyone.|{1} is the least dangerous option.|{1} is less dangerous than the others.|The danger requires {1}.
The only option that is not dangerous is to {0}.|Everything else is worse than {1}.
The truck behind is not going to like it, but {1} is still the best choice.|{1} may be uncomfortable, but it is necessary.
There is no time to think, so {0}.|The cyclist does not see us, so we must {0}.|It is not only legal but necessary to {0}.
If we fail to {0}, the child will be hit.|The consequences of not {1} would be fatal.|The pedestrian is too close to do anything else than {0}.
No other action is as safe as {1}.|I do not think anything is safer than {1}.|{1} is risky with the follower, but a collision is certain otherwise.
Although {1} is dangerous, it is the only way to avoid the cow.|{1} is never a bad idea in fog.
I cannot see the end of the queue, therefore {1} is right.|The oncoming car will not {0}.|The dog will not move, and {1} gives it time.
{1} is not too late.|Neither {1} nor waiting is dangerous here.|{1} won't hurt anyone.|{1} can't cause a collision, as the road behind is empty.
{1} is not ideal, but acceptable.|{1} prevents a collision.|{1} reduces the risk of a crash.|The worst outcome is avoided by {1}.
Nobody is endangered by {1}.|It is better to {0} than to crash.|{1} is safer than swerving into the wrong lane.|I would not hesitate to {0} here.
The road is not blocked on the other side, but {1} is safe.|It would be irresponsible not to {0}.
The overturned truck blocks both lanes and there is no way around it, so the ego must {0}.|Given the low visibility, {1} is the most prudent choice.
{1} minimizes the risk of a rear-end collision.|{1} gives the ego more time to react without endangering others.
There is not enough room to pass the cow, so I choose to {0}.|I cannot rule out that the child runs onto the road, so {1} is wise.
{1} is the safest option because the other options are dangerous.|The other options are worse than {1}.|Not {1} could lead to a serious accident.
If the ego does not {0}, it will collide with the sofa.|Unless the ego decides to {0}, a collision is unavoidable.|It would be negligent not to {0}.
While {1} may be inconvenient, it is safe.|{1} does not pose any risk to the vehicles behind.|The driver behind may not expect it, but we should {0}.
{1} is unlikely to cause a problem.|It is not necessary to do more than {0}.|It is not wrong to {0} here.|Only {1} avoids hitting the deer.
{1} should not be a problem here.|There is no danger in {1}, since the road is empty.|The truck in front cannot be passed; {1} keeps a safe distance.
The ego must not ignore the obstacle and has to {0}.|The debris is dangerous to hit, which is why we {0}.|I can't think of anything better than {1}.
{1} is preferable to a dangerous evasive manoeuvre.|The animal might not get out of the way. It is wise to {0}.
A human driver would not wait and would {0}.|With no car on the left, {1} is safe.|{1} is not without risk, but the alternatives are worse.
The lane ahead is not clear, so the ego vehicle should {0}.|There are no vehicles behind, hence {1} is safe.
{1} allows us to avoid the obstacle without endangering the cyclist.|The horse is unpredictable and dangerous, which makes {1} the best option.
{1} ensures that no collision occurs.|Other options such as swerving are too risky, while {1} is safe.
If we do not {0} now, the ego may hit the pedestrian.|It would be foolish not to {0} in such fog.
The van is not moving, and I see no reason against {1}.|We have no alternative but to {0}.|{1} is the only action that does not risk a crash.
{1} poses little risk.|{1} poses less risk than waiting.|{1} poses a lower risk.|{1} would pose minimal risk.|{1} creates less danger for others.
{1} poses the least risk.|{1} is hardly dangerous here.|There is nothing dangerous about {1} here.|{1} is not forbidden here.|{1} would not be a mistake.|I am not sure, but {1} seems right.
{1} is better than doing nothing.|Doing nothing is worse than {1}.|{1} could be dangerous if a truck were behind, but there is none.
I do not believe that {1} is too cautious.|It is hard to see, so {1} is advisable.|{1} reduces the severity of an unavoidable impact.
The pedestrian may be hit if we do not {0}.|We risk a collision if we do not {0}.|No one is in danger because of {1}.
It makes sense to {0}, as the road is not visible.|{1} is not an overreaction.|The other driver must not {0}, we must.
A sensible driver would not do anything but {0}.|I refuse to drive on and {0}.|I reject every other option, so I {0}.
Anything other than {1} is dangerous.|All actions other than {0} are dangerous.|Driving on without {1} would be fatal.|Traffic is not {1}.
The lorry is not {1}.
A deer is standing in the lane and will not move in time, so the best reaction is to {0}.
The ego vehicle is travelling too fast for the fog. {1} lowers the risk.
Since the left lane is occupied and the shoulder is too narrow, {1} is the only reasonable choice.|{1} should prevent a collision with the mattress.
The flooded road cannot be crossed safely at this speed; {1} is required.|It is crucial to {0} to avoid hitting the person.
The ego vehicle cannot avoid the tree without {1}.|Nothing suggests that {1} would be wrong.
Ordinary traffic, nothing unusual, no need to do anything other than {0}.|The situation is dangerous and I would {0}.
The wrong-way driver is dangerous; {1} gives us distance.|It is too late for a comfortable manoeuvre, so {0}.
The truck has no room to {0}, but we have.|The person on the road does not react, hence we {0}.|{1} is less risky than the alternatives.
The danger of {1} is small.|The risk of {1} is low compared with the risk of a crash.|The bus cannot {0}, so it is up to us.
Due to the obstacle, not {1} will result in a crash.|I don't see any reason not to {0}.|{1} may not be comfortable, but safety comes first.
{1} will not be a problem because nobody follows.|The pedestrian is not in our lane, but {1} is a wise precaution.
One could swerve, but that would be dangerous; {1} is better.|{1} would hardly be dangerous here.|{1} is by no means dangerous.
The safest thing is to {0} rather than to wait.|{1} will most likely avoid an accident.|A collision is impossible to avoid without {1}.
Better to {0} than to risk a crash.
""".strip().replace("\n", "|").split("|")  # fmt: skip
"""Reasons that support the action, weigh it, or are about others."""

CONDEMNING = """
{1} is too risky.|It is not safe to {0}.|It is not possible to {0}.|It is impossible to {0}.|There is no room to {0}.|There is not enough time to {0}.
{1} would cause a collision.|{1} is insufficient.|{1} will not be enough.|{1} would not prevent the collision.|{1} is not advisable.
{1} should be avoided.|{1} is not recommended.|The ego should avoid {1}.|The ego should not {0}.|The ego cannot {0}.|If we {0}, we will crash.
{1} would lead to a crash.|{1} would be a mistake.|{1} is a bad idea.|{1} is not an option.|{1} is ruled out.|I would rule out {1}.
I advise against {1}.|I would never {0} here.|{1} is the worst choice.|{1} is wrong.|{1} makes things worse.|It is a bad idea to {0}.
{1} is illegal here.|{1} would be reckless.|{1} could be fatal.|{1} would hit the cyclist.|It would be better not to {0}.|Anything but {1}.
{1} is unsafe, as a truck follows closely.|It is unsafe to {0}, as a truck follows closely.|Unfortunately, {1} is not safe here.|It is unwise to {0}.
One must under no circumstances {0}.|{1} is far too dangerous here.|We can't {0}, because the truck behind is too close.
I do not think that {1} is right.|{1} would only make things worse.|It is too late to {0}.|{1} would be foolish.|{1} is not feasible.
The ice makes {1} dangerous.|The ice makes it impossible to {0}.|We do not have enough space to {0}.|Without doubt, {1} would be fatal.
{1} will not be sufficient.|{1} would surely cause an accident.|I would advise against {1}.|I strongly recommend not to {0}.
{1} is the last thing I would do.|There is no way to {0} safely.|There is no point in {1}.|{1} would be irresponsible.
In this situation {1} is extremely dangerous.|With a truck behind us, {1} is dangerous.|You should never {0} here.|{1} is strictly forbidden here.
{1} would certainly result in a crash.|{1} does not help.|There is no need to {0}.|Under these conditions, {1} is unsafe.
The best choice is not to {0}.|{1} does not make sense.|We must not {0} under any circumstances.|{1} would put us at risk of being hit from behind.
{1} is not a good idea.|It would not be wise to {0}.|{1} is not safe because of the cyclist.|{1} would be a grave mistake.
The ego vehicle must not {0}, since a bus is right behind.|I would definitely not {0}.|{1} is certainly wrong here.|{1} is not the right choice.
It makes no sense to {0}.|There is no safe way to {0}.|{1} could result in a collision with the oncoming car.|{1} might cause a pile-up.
{1} endangers the pedestrian.|The road is icy and {1} is impossible.|{1} is highly dangerous, since the truck cannot brake in time.
Visibility is poor, which makes {1} unsafe.|I would not recommend {1}.|The ego should by no means {0}.|{1} isn't safe.|{1} isn't an option here.
{1} would be the wrong decision.|We are too close to {0}.|It's too dangerous to {0}.|It isn't possible to {0} here.|{1} would not be appropriate.
{1} is unacceptable.|It would be reckless to {0}.|{1} would be a terrible idea.|Nobody should {0} here.|{1} is not wise here.
{1} cannot prevent the collision.|I'm not going to {0}.|We don't have time to {0}.|It would be too late to {0}.|{1} would be overkill.|{1} is an overreaction.
{1} is completely unnecessary.|{1} is too dangerous with this truck behind us.|{1} is inappropriate here.|{1} would be a serious mistake.
{1} is not an appropriate response.|We won't be able to {0} in time.|There isn't enough distance to {0}.|It is better not to {0}.
I would rather not {0}.|{1} would be suicidal.|{1} is the worst thing to do.|The ego vehicle is unable to {0}.|{1} is not allowed here.
{1} must be avoided at all costs.|{1} is certainly not the best action.|{1} is not warranted.|{1} poses a serious danger to the cyclist.
{1} poses the greatest risk.|{1} is the most dangerous option.|{1} poses more risk than waiting.
{1} would almost certainly cause a crash.|{1} would kill the cyclist.|We should avoid {1}.|Due to the ice, {1} is not possible.
I cannot recommend {1}.|{1} is therefore ruled out.
{1} is not the answer here.|{1} would be downright dangerous.|Sadly we cannot {0}.|{1} would be extremely risky.|It would be irresponsible to {0}.
We must not {0} here.|I do not want to {0}.|I would not {0}, as the road is icy.|{1} would be catastrophic.|{1} is simply impossible.
{1} is not a viable option.|{1} creates a hazard.|{1} is neither safe nor legal.|The right action is not {1}.|{1} is unnecessarily dangerous.
It's unsafe to {0}.|{1} won't work.|{1} would be disastrous.|It seems unwise to {0}.|{1} would not be safe.|There is insufficient room to {0}.
{1} would collide with the oncoming car.|{1} would lead to a rear-end collision.|It is inadvisable to {0}.|One should not {0} in this situation.
Please do not {0}.|{1} cannot be the right choice.|On no account should we {0}.
""".strip().replace("\n", "|").split("|")  # fmt: skip
"""Reasons that deny or condemn the action."""


def is_read(form: str, action: str) -> bool:
    reason = form.format(*NAMES[action])
    said = {"reasoning": reason[0].upper() + reason[1:], "action": action}
    return read_action(json.dumps(said)).value == action


@pytest.mark.parametrize("action", NAMES)
def test_reasons_for_the_action_are_read(action):
    assert [form for form in SUPPORTING if not is_read(form, action)] == []


@pytest.mark.parametrize("action", NAMES)
def test_reasons_against_the_action_make_it_unreadable(action):
    assert [form for form in CONDEMNING if is_read(form, action)] == []


@given(
    st.sampled_from(list(NAMES)),
    st.sampled_from(["It {is_} {word} {to} {{0}}.", "{not_}{{1}} {is_} {word}."]),
    st.sampled_from([("is", 0), ("is not", 1), ("would be", 0), ("would not be", 1)]),
    st.sampled_from([("safe", 0), ("wise", 0), ("dangerous", 1), ("too risky", 1), ("a mistake", 1)]),
    st.booleans(),
)  # fmt: skip
def test_two_denials_cancel_each_other(action, form, is_, word, is_negated):
    to, not_ = ("not to", "not ") if is_negated else ("to", "")
    said = form.format(is_=is_[0], word=word[0], to=to, not_=not_)
    assert is_read(said, action) is ((is_[1] + word[1] + is_negated) % 2 == 0)


@pytest.mark.parametrize(
    ("reason", "value"),
    [
        ("A sudden stop is dangerous, so I brake gently to a stop.", "stop"),
        ("A hard stop is not needed; a calm stop is enough.", "stop"),
        ("Stopping in the lane is dangerous in general, but here it is the safest.", "stop"),
        ("Although stopping is dangerous, slowing down is not.", None),
        ("Should we not stop?", "stop"),
        ("We must not stop abruptly.", "stop"),
        ("I should not just stop but also warn the others.", "stop"),
        ("I must not stop unless the lane is blocked.", "stop"),
        ("I would not, by the way, stop.", None),
        ("The car is on the wrong side. This is wrong.", "stop"),
        ("This is wrong.", None),
        ("Not recommended.", None),
        ("The opposite.", None),
        ("That is not what I would do.", None),
    ],
)
def test_what_else_is_for_or_against_it(reason, value):
    assert read_action(json.dumps({"reasoning": reason, "action": "stop"})).value == value


@pytest.mark.parametrize(
    ("reason", "value"),
    [
        ("A deer on the road is dangerous.", "deer"),
        ("A deer on the road could cause an accident.", "deer"),
        ("Option 1 is wrong.", None),
        ("This is not a deer on the road.", None),
        ("Option 2 is not correct.", "deer"),
    ],
)
def test_danger_condemns_no_thing_of_the_closed_question(reason, value):
    labels = {"deer": "Deer on the road", "box": "Box on the road"}
    assert read_choice(json.dumps({"reasoning": reason, "choice": 1}), labels).value == value


def test_endless_clauses_without_an_option_do_not_take_long():
    answer = json.dumps({"reasoning": "not, it, " * 9_000, "action": "stop"})
    begun = time.process_time()
    assert read_action(answer).value == "stop"
    assert time.process_time() - begun < 4.0
