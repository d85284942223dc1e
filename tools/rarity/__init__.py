"""Makes the head that estimates rarity offline."""
