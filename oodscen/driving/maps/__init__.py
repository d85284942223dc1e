"""The shipped OpenDRIVE files."""
