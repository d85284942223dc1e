from ._base import Prompt as Prompt
from ._versions import QUESTIONS as QUESTIONS
