"""The parts of the conformance check: what an adapter promises, and how each promise is tried."""
