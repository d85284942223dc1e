"""Reference drivers for driving stacks, and their shared perception and car following."""
