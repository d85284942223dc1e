"""One function per stage of a study: each reads what is there and adds what is missing."""
