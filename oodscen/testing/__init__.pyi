from ._check import check_simulator as check_simulator
from ._check import simulator_checks as simulator_checks
from ._llm import ScriptedLLM as ScriptedLLM
from ._scenes import example_scene as example_scene
from ._server import AnsweringServer as AnsweringServer
from ._truth import check_truth as check_truth
