"""The largest numbers that can be asked for: what is beyond them is a mistake."""

__all__ = ["MOST", "MOST_FREQUENCY", "MOST_STEPS"]

# No memory holds so many normals, cells or samples.
MOST = 10**9
# An icosphere of this frequency has 10⁹ vertices, a HEALPix grid of this `nside` has more pixels.
MOST_FREQUENCY = 10**4
# More steps of relaxation would hardly move anything.
MOST_STEPS = 10
