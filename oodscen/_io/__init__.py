"""Files, their formats, and the locks on them."""
