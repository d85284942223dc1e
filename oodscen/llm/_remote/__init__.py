"""The litellm client: transport, bounds, limits, failures, redaction."""
