"""The commands: `parser` declares them without heavy imports, a module each does their work."""
