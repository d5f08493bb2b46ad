"""Data sets of many parts: creation by several processes, and reading."""
