"""The kinematic world: bodies, behaviours, triggers and the discrete actions."""
