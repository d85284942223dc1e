"""The built-in author: text answers from a knowledge base of hazards, without any model."""

from oodscen.llms.author.builtin import BuiltinAuthor
from oodscen.llms.author.knowledge import Knowledge
from oodscen.llms.author.shelf import load_knowledge
from oodscen.llms.author.validation import validate_knowledge

__all__ = ["BuiltinAuthor", "Knowledge", "load_knowledge", "validate_knowledge"]
