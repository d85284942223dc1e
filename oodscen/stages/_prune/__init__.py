"""What pruning found out: what would restore a branch, and two simulators side by side."""
