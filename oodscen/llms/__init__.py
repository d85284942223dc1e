"""Language models: any provider through litellm, the built-in author, answerers that see nothing."""
