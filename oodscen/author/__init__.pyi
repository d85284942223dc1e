from ._builtin import BuiltinAuthor as BuiltinAuthor
from ._knowledge.base import Knowledge as Knowledge
from ._knowledge.inspection import inspect_knowledge as inspect_knowledge
from ._knowledge.loading import load_knowledge as load_knowledge
from ._knowledge.validation import validate_knowledge as validate_knowledge
