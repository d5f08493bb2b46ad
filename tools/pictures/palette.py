"""The colours and the style of all pictures."""

# Blue for elliptic and orange for hyperbolic, which colour-blind people can distinguish (Okabe and
# Ito). The neutral colour of the scale is zero curvature.
ELLIPTIC, HYPERBOLIC, NO_SAMPLE = "#0072b2", "#d55e00", "#a8a8a8"
PARABOLIC = "#555555"
# From the same palette: samples that fill gaps, samples on a grid, and the marked normal.
FILLING, GRID, MARK = "#cc79a7", "#009e73", "#f0e442"
SCALE = ("#7a2e00", HYPERBOLIC, "#f3b183", "#f7f7f7", "#8cc4e8", ELLIPTIC, "#003c66")
INK, PALE, FAINT, GLOBE = "#333333", "#8a8a8a", "#e4e4e4", "#eceef0"
STYLE = {
    "axes.edgecolor": PALE,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.5,
    **{f"axes3d.{axis}axis.panecolor": (1.0, 1.0, 1.0, 0.0) for axis in "xyz"},
    "font.size": 8.0,
    "grid.color": FAINT,
    "grid.linewidth": 0.4,
    "svg.hashsalt": "gaussmap",
    "text.color": INK,
}
