"""Samples: their fields, their report, and the surfaces on which they lie."""
