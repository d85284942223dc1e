"""Red teaming: the rounds, their log, the stopping rules, and estimates of what is left to find."""
