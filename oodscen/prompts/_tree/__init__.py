"""Questions that grow, widen and prune the tree."""
