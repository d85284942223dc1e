"""Changes of staged scenes that their own drives ask for."""
