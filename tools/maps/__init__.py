"""Designs of the shipped OpenDRIVE maps, and the scripts that write and draw them."""
