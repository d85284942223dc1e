from ._knowledge.inspection import inspect_knowledge as inspect_knowledge
from ._knowledge.loading import load_knowledge as load_knowledge
