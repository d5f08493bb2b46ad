"""Messages of the library at the command line: options, and no names of Python."""

import pytest
from gaussmap.tools.commands.wording import for_commands


@pytest.mark.parametrize(
    ("message", "said"),
    [
        (
            'density="gauss" does not go with coverage=...; use normals=... or count=....',
            "--density gauss does not go with --coverage; use --normals or --count.",
        ),
        ("if so, say nodata=-3.4e+38.", "if so, say --nodata -3.4e+38."),
        ("edges=True is for CAD parts; no edges.", "--edges is for CAD parts; no edges."),
        ("source_crs=… is missing.", "--source-crs is missing."),
        ("the unit or dtype=numpy.float64.", "the unit or double precision."),
        ("of CAD parts only; see gm.read_part.", "of CAD parts only."),
        ("5 faces failed (see part.failed); the angle is 3°.", "5 faces failed; the angle is 3°."),
        ("take fewer, or some, as in samples.mesh()[:5].view(path).", "take fewer, or some."),
        ("it has 90 pieces; gm.fit(surface) gives one spline.", "it has 90 pieces."),
        # names of files
        ("'x=5.npy' does not exist.", "'x=5.npy' does not exist."),
        ("'a/part.failed', 'gm.txt' and 'part.save' are damaged; write them again.",
         "'a/part.failed', 'gm.txt' and 'part.save' are damaged; write them again."),
    ],
)  # fmt: skip
def test_arguments_are_options_and_functions_are_left_out(message: str, said: str) -> None:
    assert for_commands(message) == said
