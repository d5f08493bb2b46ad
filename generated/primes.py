"""The largest primes of which sums of twelve products of two fit into 64 bits.

Written by `make generate`, SymPy 1.14.0, float64, no fast-math: do not edit, change symbolic/.
"""

import numpy as np

PRIMES = np.array([
    536870909, 536870879, 536870869, 536870849, 536870839, 536870837, 536870819, 536870813, 536870791,
    536870779, 536870767, 536870743, 536870729, 536870723, 536870717, 536870701, 536870683, 536870657,
    536870641, 536870627, 536870611, 536870603, 536870599, 536870573,
])  # fmt: skip
