"""Threads: the same results in the same order, and errors that end the work."""

import threading

import gaussmap as gm
import numpy as np
import pytest


@pytest.mark.compiled
def test_several_python_threads_at_once():
    """One spline, whose cached parts are made on first use, and several surfaces."""
    names = ["torus", "sphere", "enneper", "catenoid"]
    shared = gm.fit(gm.surfaces.torus(), (24, 24))
    expected = [gm.sample(gm.surfaces.surface(x), count=500, cells=(24, 24)).points for x in names]
    expected += [
        gm.sample(gm.fit(gm.surfaces.torus(), (24, 24)), normals=gm.icosphere(8)).points
    ] * 4
    found: list[object] = [None] * 8
    start = threading.Barrier(8, timeout=30)

    def work(k):
        start.wait()
        if k < 4:
            surface = gm.surfaces.surface(names[k])
            found[k] = gm.sample(surface, count=500, cells=(24, 24)).points
        else:
            found[k] = gm.sample(shared, normals=gm.icosphere(8)).points

    workers = [threading.Thread(target=work, args=(k,)) for k in range(8)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_array_equal(one, other)
