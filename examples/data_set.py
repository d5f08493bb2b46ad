"""A data set for learning: 1,000 random surfaces, 2,048 points of each, on all cores.

Three of the surfaces are bad: the manifest says why. Run it again: there is nothing left to do.
"""

import gaussmap as gm
import numpy as np

COUNT, POINTS = 1_000, 2_048
BROKEN = {17: "NaN", 400: "scalars", 999: "an exception"}


def waves(seed):
    """Return a function: a random sum of waves over the square."""
    rng = np.random.default_rng(seed)
    frequencies, phases = rng.uniform(0.5, 3.0, (4, 2)), rng.uniform(0, 2 * np.pi, 4)
    heights = rng.uniform(0.05, 0.2, 4)

    def position(u, v):
        z = sum(
            h * np.sin(a * u + b * v + p)
            for h, (a, b), p in zip(heights, frequencies, phases, strict=True)
        )
        return np.stack([u, v, z], axis=-1)

    return position


def broken(kind):
    """Return a function that defines no surface."""

    def position(u, v):
        if kind == "an exception":
            raise ValueError("no such shape")
        if kind == "scalars":
            return u
        return np.stack([u, v, np.full_like(u, np.nan)], axis=-1)

    return position


def surface(number):
    """Return a surface; no function is called before it is sampled."""
    f = broken(BROKEN[number]) if number in BROKEN else waves(number)
    return gm.Surface.from_callable(f, domain=((-1, 1), (-1, 1)), name=f"waves {number}")


def main():
    dataset = gm.sample_many(
        [surface(number) for number in range(COUNT)],
        POINTS,
        density="uniform",
        cells=(24, 24),
        fields=("points", "normals"),
        dtype=np.float32,
        out="waves",
    )
    print(dataset.summary())
    for row in dataset.manifest().to_pylist():
        if row["status"] == "failed":
            print(f"{row['name']}: {row['error']}")
    clouds = np.full((COUNT, POINTS, 3), np.nan, dtype=np.float32)
    for points, _, part in dataset.clouds(POINTS):
        clouds[part] = points
    check(dataset, clouds)


# --- Is it true? Points lie on their surfaces; the manifest has all bad surfaces, and reasons. ---


def check(dataset, clouds):
    manifest = dataset.manifest(("part", "status", "error")).to_pylist()
    errors = {row["part"]: row["error"] for row in manifest if row["status"] == "failed"}
    assert list(errors) == list(BROKEN)
    for error, why in zip(errors.values(), ("not finite", "shape", "no such shape"), strict=True):
        assert why in error
    bad = np.isnan(clouds).any(axis=(1, 2))
    assert np.flatnonzero(bad).tolist() == list(BROKEN)
    # Rounding x, y and z < 1 to single precision moves each by 2**-25 at most, and a slope is
    # below 4 * 0.2 * 3 * sqrt(2) < 3.4.
    bound = 2**-25 * (1 + 3.4 * np.sqrt(2))
    for number in np.flatnonzero(~bad):
        x, y, z = clouds[number].astype(float).T
        assert max(np.abs(x).max(), np.abs(y).max()) <= 1
        assert np.abs(z - waves(number)(x, y)[:, 2]).max() < bound
        assert len(np.unique(clouds[number], axis=0)) == POINTS


if __name__ == "__main__":
    main()
