"""Reading of English texts: clauses, labels, settings and claims, from words alone."""
