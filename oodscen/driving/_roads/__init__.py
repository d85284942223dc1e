"""OpenDRIVE roads: parsing, corridors, lanes and look-ups."""
