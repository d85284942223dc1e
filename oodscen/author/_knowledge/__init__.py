"""The knowledge base of hazards: its entries, loading, validation and inspection."""
