"""`Picture`: a Matplotlib figure that notebooks show."""

from io import BytesIO

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure


class Picture(Figure):
    """A figure that notebooks display, and that pyplot does not keep in memory."""

    def __init__(self, *arguments: object, **options: object) -> None:
        """Make a figure with the canvas of Agg."""
        super().__init__(*arguments, **options)  # pyright: ignore[reportArgumentType]
        FigureCanvasAgg(self)

    def _repr_png_(self) -> bytes:
        content = BytesIO()
        self.savefig(content, format="png")
        return content.getvalue()
