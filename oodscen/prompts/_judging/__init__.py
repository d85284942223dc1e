"""Questions to judged models and to the judge."""
