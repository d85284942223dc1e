"""One function per stage of a study; each reads existing results and adds the missing ones."""
