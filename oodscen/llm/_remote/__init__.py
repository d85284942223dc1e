"""The litellm client: transport, bounds, limits and failures."""
