"""Staging by recipe: actors, lanes, weather, background traffic and the timing of the decision."""
