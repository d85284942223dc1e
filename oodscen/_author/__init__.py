"""The built-in author: writes answers from a knowledge base of hazards, without a model."""

from oodscen._author.builtin import BuiltinAuthor
from oodscen._author.knowledge.base import Knowledge
from oodscen._author.knowledge.loading import load_knowledge
from oodscen._author.knowledge.validation import validate_knowledge

__all__ = ["BuiltinAuthor", "Knowledge", "load_knowledge", "validate_knowledge"]
