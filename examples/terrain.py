"""20,000 points of a digital elevation model, in world coordinates: a GeoTIFF in, a LAS file out.

Needs `pip install "gaussmap[gis]"`. On the command line it is one line:

    gaussmap sample dem.tif --count 20000 -o points.las
"""

import subprocess
import sys
from pathlib import Path

import gaussmap as gm
import laspy
import numpy as np
import rasterio
from rasterio.crs import CRS
from rasterio.transform import from_origin

COUNT, PIXEL, NODATA = 20_000, 30.0, -9999.0
ROWS, COLUMNS, LAKE = 180, 240, (slice(40, 60), slice(100, 140))  # without heights in the lake
WEST, NORTH = 500_000.0, 5_200_000.0


def height(east, north):
    x, y = (east - WEST) / 800, (north - NORTH) / 600
    return 1_200 + 150 * np.sin(x) * np.cos(y) + 40 * np.sin(2 * x + y)


# The file is made here, by Rasterio, with heights at the centres of pixels.
transform = from_origin(WEST, NORTH, PIXEL, PIXEL)
column, row = np.meshgrid(np.arange(COLUMNS) + 0.5, np.arange(ROWS) + 0.5)
east, north = transform @ (column, row)
heights = height(east, north)
heights[LAKE] = NODATA
with rasterio.open(
    "dem.tif", "w", driver="GTiff", width=COLUMNS, height=ROWS, count=1, dtype="float64",
    crs="EPSG:32632", transform=transform, nodata=NODATA,
) as file:  # fmt: skip
    file.write(heights, 1)

samples = gm.sample(gm.terrain("dem.tif"), COUNT)
samples.write("points.las")
print(samples.summary())
command = [str(Path(sys.executable).with_name("gaussmap")), "sample", "dem.tif"]
subprocess.run([*command, "--count", str(COUNT), "-o", "again.las"], check=True)

# --- Is it true? By the transform of Rasterio, the function of the heights, and laspy. ---

for name in ("points.las", "again.las"):
    cloud = laspy.read(name)
    x, y, z = points = np.array([cloud.x, cloud.y, cloud.z])
    assert len(cloud.x) == COUNT
    (record,) = cloud.header.vlrs.get("WktCoordinateSystemVlr")
    assert CRS.from_wkt(record.string).to_epsg() == 32632
    assert np.abs(points.T - samples.points).max() <= max(cloud.header.scales)
    # Inside the centres of the pixels, and none where heights are missing.
    column, row = ~transform @ (x, y)
    assert min(column.min(), row.min()) > 0.5 - 1e-6
    assert column.max() < COLUMNS - 0.5 + 1e-6
    assert row.max() < ROWS - 0.5 + 1e-6
    in_lake = (np.abs(column - 120) < 20) & (np.abs(row - 50) < 10)
    assert not in_lake.any()
    # The coefficients of the spline are means of neighbouring heights. The distance of the spline
    # from the hills is at most half of their second derivatives times the square of a pixel:
    # 150/600² + 40 (2/800 + 1/600)² < 0.0012.
    assert np.abs(z - height(x, y)).max() < 0.0012 * PIXEL**2
normals = samples.normals
assert (normals[:, 2] > 0).all()
d = 1e-3  # metres: differences of heights of 1e3 have an error of 1e-13/1e-3, and of d² besides
x, y, z = samples.points.T
slopes = [
    (height(x + d, y) - height(x - d, y)) / (2 * d),
    (height(x, y + d) - height(x, y - d)) / (2 * d),
]
up = np.stack([-slopes[0], -slopes[1], np.ones_like(x)], axis=1)
up /= np.linalg.norm(up, axis=1, keepdims=True)
angles = np.degrees(np.arccos(np.clip((normals * up).sum(axis=1), -1, 1)))
# Half of the square of a pixel times third derivatives: 150/600³ + 40 (2/800 + 1/600)³ < 3.7e-6.
assert angles.max() < np.degrees(3.7e-6 * PIXEL**2 / 2)
print(f"normals are within {angles.max():.2f}° of those of the hills")
