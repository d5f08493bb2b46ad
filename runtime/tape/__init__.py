"""Straight-line programs of surfaces: their values, and enclosures of these over boxes."""
