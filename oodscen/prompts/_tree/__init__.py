"""Prompts that grow, widen and prune the tree."""
