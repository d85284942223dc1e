from ._versions import QUESTIONS as QUESTIONS
