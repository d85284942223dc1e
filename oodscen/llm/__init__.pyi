from ._ask import ask as ask
from ._call_log import LoggedLLM as LoggedLLM
from ._remote.limits import Caps as Caps
from ._remote.limits import Limits as Limits
from ._remote.litellm import LiteLLM as LiteLLM
from ._replay import RecordingLLM as RecordingLLM
