from ._knowledge.inspection import inspect_knowledge as inspect_knowledge
