"""The knowledge base of hazards: its entries, loading, validation, inspection."""
