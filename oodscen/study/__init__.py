"""Studies on disk: files, tables and configuration."""
