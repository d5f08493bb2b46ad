"""Domains of parameters: their boundary conditions, and trims."""
