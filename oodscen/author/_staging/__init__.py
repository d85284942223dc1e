"""Staging by recipe: actors, lanes, weather, background traffic and the moment of decision."""
