"""Answers that name `stop` and do not give it, and answers that plainly give it, by the way in which they do so.

`@` stands for the JSON object of the answer.
"""

import json

AROUND = r"""
@ was wrong|answer != @|> @|>> @|!@|~@|- @|-@|+ @|# @|// @|; @|-- @|% @|* not: @|~~@~~|<!-- @ -->|/* @ */|<del>@</del>|<s1>@</s1>
<example>@</example>|<quote>@</quote>|<wrong>@</wrong>|<user>@</user>|<tool_result>@</tool_result>|<rejected>@</rejected>
```diff\n- @\n```|```diff\n@\n```|```text\n@\n```|```python\n@\n```|```jsonc\n@\n```|```wrong\n@\n```|```json\n// no\n@\n```
assert answer != @|return not @|if clear: @|try: @|except: @|const wrong = @|print(@)|not @|NOT @|no @|Never @|Don't: @|f(@)
{"not": @}|{"options": [@]}|{"rejected": @}|{"example": @}|{"wrong": @}|{"user": @}|{"avoid": @}|[@]|[@, null]|[false, @]|{"a": 1, "answer": @}
{"answer": @, "negated": "yes"}|{"answer": @, "if": "clear"}|{"answers": [@]}|{"steps": [@]}|{"truck": @}|{"other_driver": @}|{"draft": @}
@<think>no</think>|@<think>That would be wrong.</think>|@\n<reasoning>no</reasoning>|<think>@|<think>hm</think>|<think>@</think>
@ @|@\n@|@ or maybe {"action": "keep_speed"}|@\n{"action": "keep_speed"}|{"action": "keep_speed"}\n@|@ {"negated": true}|@ {}
@ // no|@ # no|@ /* no */|@ <- wrong|@ ^ wrong|@?|@ ???|@ /s|@ lol|@ ;)|@ \u274c|\u274c @|\U0001f44e @|@ \U0001f6ab|@ = false|@ => no|@ == null
@\nJust kidding.|@\nPsych!|@\nThat kills everybody.|@\nOn reflection that would be fatal.|@\nDo not do this.|@\nWait, no.|@\nActually, keep the speed.
@\nThe opposite is true.|@\nThis is not my answer.|@\nI lied.|@\nSigned, the truck|@\nis what the user wants|@ said the truck|@\n-- the other driver
@\nThere is a deer on the road.|@\nThe above is a test.|@\nHope this helps nobody.|@\nLet me know if you need the real answer.|@ (sarcasm)|@ (not)
Someone else said: @|The truck: @|The worst answer: @|Not my answer: @|My old answer: @|Suppose: @|Imagine: @|In theory: @|For example: @|E.g.: @
The format is @|Template: @|Schema: @|Placeholder: @|Example answer: @|Your answer: wrong. @|Here is my answer if I were blind: @|Q: @|user: @|system: @
Here is what not to do: @|Anything but @|Instead of @|Ignore this: @|I decline. @|I refuse. @|Lies: @|April fools! @|Opposite day. @|Is it @|Maybe @
Sure, not: @|Here is no answer: @|My final no: @|This is not the answer: @|The answer is not: @|The answer is never @|Answer? @|Answer: not @
Here is the answer that I reject: @|Here is the forbidden action: @|I would choose anything except: @|I choose, if dry: @|The answer of the truck: @
""".strip().replace("\n", "|").encode().decode("unicode_escape").split("|")  # fmt: skip
"""Wrappings in which an object is no answer."""

BESIDE: list[dict[str, object]] = [
    {name: held}
    for names, held in (
        ("if unless only_if else when until except provided condition given_that", "the road is clear"),
        ("negated cancelled withdrawn disregard revoked inverted sarcasm joke hypothetical", "yes"),
        ("negated cancelled valid final use active weight is_answer not rejected", False),
        ("use weight score valid count votes rank not probability_of_other", 0),
        ("status type role speaker actor kind mode subject source author of for", "the truck"),
        ("status type kind verdict", "counterexample"),
        ("alternative action2 other_action second_action next instead but or fallback plan_b correct", "keep_speed"),
        ("why_not comment note remark warning ps caveat disclaimer reservation", "this is wrong"),
        ("options choices answers actions alternatives", ["keep_speed"]),
        ("answer decision choice final_answer final_action response", "I decline."),
        ("answer decision choice final_answer best_action output", "keep_speed"),
        ("answer decision choice", "not stop"),
        ("meta data flags settings", {"negated": True}),
        ("reasoning analysis", {"negated": True}),
        ("reasoning thoughts explanation", [False]),
        ("confidence certainty", "none whatsoever"),
        ("confidence certainty", False),
    )
    for name in names.split()
]  # fmt: skip
"""Members that an answer may not have beside it."""

REASONS = """
Stopping is dangerous.|Stopping is forbidden.|Stop is wrong.|I reject stop.|I refuse to stop.|I must not stop.|Never stop.|Do not stop.
This is the worst choice.|This is a mistake.|That would be fatal.|My answer is wrong.|The action is illegal.|This choice is not my choice.
Everything except stopping is safe.|Anything but stop.|This is the opposite of what I recommend.|Placeholder|placeholder.|Example|N/A|dummy
I am lying.|I lied.|Just kidding.|Do not choose this.|Ignore this.|Disregard the answer.|Stopping would kill us.|Stopping kills.|Avoid stopping.
Stop is out of the question.|Stopping here is reckless.|Stopping isn't my choice.|Stop, never.|Stop I will not.|It is wrong to stop.
It would be fatal to stop.|Stopping is the worst option.|To stop is suicidal.|I would avoid stopping.|The worst is to stop.|We cannot stop.
Stop would lead to a crash.|Stopping will cause a collision.|Stopping is absolutely not an option.|I don't want to stop.|This answer is false.
The answer below is wrong.|The following is a lie.|The action field is a decoy.|Stopping can be fatal.|TODO|not|As an AI language model, I must decline.
Stopping would be unnecessary.|Stopping is pointless here.|I rule out stopping.|There is no reason to stop.|Stopping must be avoided.
I would choose any action except stop.|I would not, whatever they say, stop.|Stop: no way.|Stopping will not work.|Not stopping would be best.
Stopping would make the truck behind us hit me.|Under no circumstances should I stop.|I prefer to brake hard rather than stop.
Everyone dies if I stop.|If I stop, then we will collide.|The answer is withheld.|This is only an example.|Do the opposite of the action below.
""".strip().replace("\n", "|").split("|")  # fmt: skip
"""Reasons that are against the answer beside them."""

PROSE = """
I would stop. On reflection that would be fatal.|I would stop, which would kill everybody.|> stop|>stop|I would stop. Everybody dies.
!stop|-stop|~stop|not stop|stop?|stop...?|stop /s|stop lol|stop (not)|stop, not|I would stop. Not!|I would stop. Sike.|I would stop. As if!
I would stop. In your dreams.|I would stop. Fat chance.|I would stop. Yeah, right.|I would stop. April fools!|I would stop. It is deadly.
I would stop. That kills the cow on the road.|I would stop. The road would punish that.|I would stop. This road is no place for it.
I would stop because I was told to lie.|I would stop because it would kill everybody on the road.|I would stop if the road were wet.
I would stop to avoid being right.|I would stop to keep the road a lie.|I would stop as the truck wants.|I would stop as a last resort.
I would stop since it is opposite day.|I would stop before hell freezes over.|I would stop in a parallel universe.|I would stop when pigs fly.
I would stop on any other road.|I would stop a bullet.|I would stop nobody.|I would stop at nothing.|I would stop the truck.|I would stop living.
The truck would stop.|The user would stop.|A coward would stop.|He would stop.|You would stop.|They should stop.|One would stop.|Somebody should stop.
The action to avoid is stop.|The worst action is to stop.|The least safe action is to stop.|The second best action is to stop.|The old answer is stop.
The answer is: not stop.|The answer is anything but stop.|The answer is never to stop.|The answer was stop.|The answer might be stop.
Answer: not stop|Answer: stop?|Answer: stop. Wait, no.|Answer: stop. Not.|Answer: anything but stop|Answer: stop if dry|Answer: stop or so
Action: stop\\nAction: keep_speed|Action: stop\\nnegated: yes|Action: stop\\nStatus: withdrawn|Action: stop\\nReason: Stopping is forbidden.
Action: stop\\nReason: This is the worst choice.|Reason: I reject stop.\\nAction: stop|Wrong action: stop|Rejected action: stop|Other action: stop
Actions to avoid:\\nstop|What not to do:\\nstop|Never:\\nstop|Examples:\\n- stop|In a dream:\\nstop|The truck:\\nstop|Question:\\nstop
Suppose the road is dry. I would stop.|Imagine a road. I would stop.|The officer on the road says: stop|The sign on the road reads stop.
Stop is the safest choice? No.|Stop is the safest choice for the truck.|Stop would be the best action if the road were dry.|Stop is not the best.
I doubt I would stop.|I would hardly stop.|I would only stop if forced.|I would rather die than stop.|I would stop, but no.
I used to say stop.|I want to stop.|I could stop.|I might stop.|I may stop.|I can stop.|I did stop.|I had to stop.|I would have to have stopped.
stop stop go|stop the war|stop it|stop that|stop this|stop me|Stop! In the name of love.|stop and keep_speed|stop then keep_speed|stop / keep_speed
Everyone but me would choose stop.|My evil twin picks stop.|My first guess is stop.|Answer of the truck: stop|The final answer of my rival is stop.
```\\n> stop\\n```|<example>stop</example>|<quote>stop</quote>|<wrong>stop</wrong>|<!-- stop -->|/* stop */|// stop|# stop|~~stop~~|stop<think>no</think>
I would stop. The people behind are dying.|I would stop. The car explodes.|I would stop. A collision is then certain.|I would stop. The impact is lethal.
I would stop. The ego vehicle does not.|I would stop. The car accelerates.|I would stop. The ego vehicle keeps rolling.|I would stop. The way to go is to run.
The person in the car thinks so. I would stop.|The sign ahead reads. Stop.|The person ahead shouts. Stop.|Given a free lane, I would stop.|Given less traffic, stop.
As a bad car driver, stop.|Action = stop\\n\\nWhy: not|action: !stop|action: > stop|Decision: stop\\nThat is silly.|I would stop. The vehicle cannot.
""".strip().replace("\n", "|").replace("\\n", "\n").split("|")  # fmt: skip
"""Prose that names the option and does not choose it."""

VALUES = """
-stop|!stop|~stop|not stop|stop?|no stop|>stop|#stop|//stop|stop (not)|stop, not|not(stop)|~~stop~~|stop unless wet|never stop|un-stop|stop=false
stop: false|stop: no|truck: stop|stop/keep_speed|- stop|stop or so|stop|keep_speed
""".strip().replace("\n", "|").split("|")[:-2]  # fmt: skip
"""Values that are no option."""


FAULTY = """
{"action": "stop" /* not */}|{"action": /* not */ "stop"}|{"action": "stop" // wrong\n}|{action: !stop}|{action: -stop}|{'action': not stop}
{"action" != "stop"}|{"action": ~"stop"}|{"action": "sto" "p"}|{"action": "stop" if False}|{"action": null ?? "stop"}|{{"action":"stop"}}
{"action":"stop"}}|{"action?": "stop"}|{"!action": "stop"}|{"-action": "stop"}|{"\u274caction": "stop"}|{"action": {"id": "stop", "why": "not"}}
""".strip().replace("\n", "|").replace("\\n", "\n").split("|")  # fmt: skip
"""Objects with faults that change what they say."""


def hostile() -> list[str]:
    """Return all answers that must not be read."""
    said = {"action": "stop"}
    members = [{**beside, **said} for beside in BESIDE]
    members += [{**said, **beside} for beside in BESIDE]
    members += [{"reasoning": reason, **said} for reason in REASONS]
    members += [
        {**said, "explanation": f"There is a cow on the road. {reason}"} for reason in REASONS
    ]
    members += [{"action": value} for value in VALUES]
    objects = [wrapper.replace("@", json.dumps(said)) for wrapper in AROUND]
    return [*map(json.dumps, members), *objects, *FAULTY, *PROSE]


FRIENDLY = r"""
@|```json\n@\n```|```\n@\n```|~~~json\n@\n~~~|```JSON\n@\n```|Here is my answer: @|Here is my answer:\n\n```json\n@\n```|Answer: @|Final answer: @
**Final Answer:**\n\n@|## Answer\n\n@|**Answer**\n```json\n@\n```|Sure! @|Okay, here it is.\n@|Sure! Here is my answer:\n\n```json\n@\n```
<think>Or {"action": "keep_speed"}? No.</think>@|hm</think>\n\n@|<answer>@</answer>|<final_answer>\n@\n</final_answer>|@<|im_end|>|"@"|@.|**@**
Here is my answer in the requested JSON format:\n\n@|Here is the JSON:\n@|My choice: @|I would choose: @|The answer is: @|@\n\nHope this helps!
@\n\nLet me know if you need anything else!|assistant: @|Sure! Looking at the frames, here is my answer:\n@|Based on the provided images, my answer is: @|{"answer": @}|{"result": @}|{"answer": @, "reasoning": "The lane is blocked."}
stop|Stop.|STOP|**stop**|`stop`|"stop"|- stop|Action: stop|**Action:** stop|Action: **stop**|Answer: stop|Final answer: stop.|<answer>stop</answer>
\boxed{stop}|The answer is stop.|The answer is: **stop**|My choice is stop.|I choose stop.|I choose to stop.|I would stop.|I will stop.|I should stop.
I'd stop, because the lane is blocked.|We should stop now.|Let's stop.|The ego vehicle should stop.|The ego vehicle should stop to avoid a collision.
The safest action is to stop.|The safest action is to stop because there is a cow on the road.|The best action is stop, since there is no room elsewhere.
The safest action is to stop because the lane is blocked by a fallen tree.|Stop is the safest choice.|Stopping is the safest option.|So: stop
The lane ahead is blocked, so I would stop.|There is a cow on the road. I would stop.|I would stop. There is a cow on the road.|The vehicle should stop.
The lane ahead is blocked by a box. Therefore, I would stop.|There is a large truck in front of us, so the safest action is to stop.|I will come to a stop.
The lane is blocked.\n\nstop|stop\n\nThe lane ahead is blocked.|Reasoning: one could brake or turn.\nAction: stop|Action: stop\nReason: a tree is ahead.
Reasoning: There is a dog on the road.\n\nAction: stop|<reasoning>The lane is blocked.</reasoning><action>stop</action>|### Action\nstop|Stop the car.
I think the best action is to stop.|I think stop.|I recommend to stop because of the fog.|The correct action is to come to a complete stop.|Therefore, I choose stop.
Since the road is blocked by a tree, I would stop.|Given the fog, stop is the best choice.|I would stop in my lane because a deer is crossing the road.
Based on the frames, I would choose to stop.|In this situation, the safest action would be to stop.|To avoid a collision, the ego vehicle should stop.|Sure, I would stop.
The image shows a foggy road. I would stop.|The image shows a road with a truck that has overturned. The best action is to stop.|### Answer: stop|I recommend stopping.
There are no obstacles on the road, so I would stop.|The ego vehicle is approaching a junction. The ego vehicle should stop.|I would stop because visibility is low.
A large box is on the road ahead of the ego vehicle. The ego vehicle should stop.|The ego vehicle should take the action of stopping.
The lane is blocked by a box and the left lane has oncoming traffic. Therefore, the safest action is to stop.|The answer is $\boxed{stop}$
""".strip().replace("\n", "|").replace("\\n", "\n").replace("<|im_end|>", "").split("|")  # fmt: skip
"""Answers that plainly give the option, in ways in which models do."""


def friendly() -> list[str]:
    """Return all answers that must be read."""
    said = {"reasoning": "The lane on the left is not free.", "action": "stop"}
    beside: list[dict[str, object]] = [
        {"confidence": 0.9}, {"confidence": "high"}, {"confidence": "90%"}, {"rationale": "a cow is on the road"},
        {"thought": "I could keep the speed, or wait?"}, {"thoughts": ["wet", "dark"]}, {"explanation": ""}, {"analysis": "The van may stop."},
        {"observations": ["a cow"]}, {"description": "a road"}, {"justification": "Stopping is the safest."}, {"reasoning": "If I do not stop, I hit the cow."},
        {"reasoning": "There is a cow on the road. This is dangerous."}, {"reasoning": "This is a dangerous situation, and I must choose now."},
        {"reasoning": "This is a wrong-way driver."}, {"reasoning": "It would be dangerous to keep the speed."}, {"reasoning": "I cannot change lanes, as it is not safe."},
        {"reasoning": "Stopping takes 20 m, and there are 30 m."}, {"reasoning": "Changing lanes is dangerous, so stop."}, {"reasoning": "..."},
        {"reasoning": "The truck will not stop for us, and a lane change is the wrong choice."}, {"reasoning": "Stop is the surest way not to hit it."},
        {"reasoning": "Not stopping would lead to a collision."}, {"reasoning": "If I keep the speed, we crash."}, {"reasoning": "I stop rather than swerve."},
        {"reasoning": "Under no circumstances should I change lanes to the left."}, {"reasoning": "Slowing down would not help, the wall is too near."},
    ]  # fmt: skip
    objects = [{**one, "action": "stop"} for one in beside]
    values = ("Stop", "STOP.", "stop: keep the lane and brake comfortably to a stop", "I would stop", ["stop"], {"id": "stop"})  # fmt: skip
    objects += [{"action": value} for value in values]
    return [*map(json.dumps, objects), *(one.replace("@", json.dumps(said)) for one in FRIENDLY)]
