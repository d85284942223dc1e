"""Light: sun, lamps, shadows, reflections, shelter."""
