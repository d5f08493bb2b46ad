"""Samples: their fields, their report, and what they lie on."""
