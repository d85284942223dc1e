"""OpenDRIVE roads: reading, corridors, lanes and look-ups."""
