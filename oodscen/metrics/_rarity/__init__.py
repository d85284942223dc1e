"""Rarity: expected kilometres between two meetings with a kind of situation, with its interval."""
