"""Things and movements made to order: designing them, looking at them, and their sheet."""
