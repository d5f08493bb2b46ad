"""Straight-line programs of surfaces: their values, and enclosures of the values over boxes."""
