"""Prompts that write, read and stage texts."""
