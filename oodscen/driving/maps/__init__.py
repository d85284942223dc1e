"""The shipped OpenDRIVE files, and the script that writes them."""
