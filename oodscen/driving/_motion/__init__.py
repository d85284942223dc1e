"""The kinematic world: bodies, behaviours, triggers and discrete actions."""
