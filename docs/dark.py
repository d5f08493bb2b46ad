"""Dark variants of pictures: light and dark are exchanged, and hues stay.

The site does the same to other pictures, by a filter of CSS (docs/_static/site.css).
"""

from __future__ import annotations

import numpy as np
from gaussmap.tools.pictures.palette import MARK
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

BACKGROUND = "#0d1117"  # of dark pages of GitHub
# The weights of red, green and blue in the luminance, as in the CSS filter hue-rotate. A colour is
# reflected at the grey of its luminance, which turns its hue by 180°.
LUMINANCE = np.array([0.213, 0.715, 0.072])


def dark(colours: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return the colours (k, 3) of the dark variant of a picture with white ground.

    White becomes the background, black becomes white, and marks keep their colour.
    """
    opposite = 1.0 - colours / 255.0
    turned = np.clip(2.0 * (opposite @ LUMINANCE)[:, None] - opposite, 0.0, 1.0)
    ground = np.array(to_rgb(BACKGROUND))
    found = np.round(255.0 * (ground + turned * (1.0 - ground))).astype(np.uint8)
    marks = np.round(255.0 * np.array(to_rgb(MARK))).astype(np.uint8)
    found[(colours == marks).all(axis=1)] = marks
    return found
