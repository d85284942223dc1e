"""The task folder for lmms-eval."""
