from ._base import Prompt as Prompt
from ._questions import QUESTIONS as QUESTIONS
