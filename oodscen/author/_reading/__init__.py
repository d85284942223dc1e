"""Reading English: clauses, labels, settings and claims from words alone."""
