"""The built-in behaviours of actors: their table, and a kernel for each."""
