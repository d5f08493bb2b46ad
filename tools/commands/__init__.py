"""The commands: `parser` declares them without heavy imports; a module for each does the work."""
