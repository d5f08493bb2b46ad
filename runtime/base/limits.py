"""The largest numbers that are accepted as arguments: larger ones are mistakes."""

# The largest number of normals, cells or samples: more do not fit into memory.
MOST = 10**9
# An icosphere of this frequency has 10⁹ vertices, a HEALPix grid of this `nside` 1.2 × 10⁹ pixels.
MOST_FREQUENCY = 10**4
