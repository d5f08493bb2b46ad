"""Data sets of many parts: how they are made, by many processes, and how they are read."""
