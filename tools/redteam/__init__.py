"""Pictures of red teams for the documentation."""
