"""Out-of-distribution driving scenarios: from a language model to judged episodes."""
