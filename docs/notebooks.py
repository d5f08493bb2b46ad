"""Run the scripts of docs/gallery/ as notebooks, and write them with their outputs.

A script is a notebook in Jupytext's percent format, with text cells as comments.
"""

from __future__ import annotations

import argparse
import base64
from io import BytesIO
from pathlib import Path

import jupytext
from nbclient import NotebookClient
from nbformat import NotebookNode, write
from PIL import Image

GALLERY = Path(__file__).parent / "gallery"
SECONDS = 300  # for one cell; the first sampling may compile


def notebook(script: Path) -> NotebookNode:
    """Return the notebook of a script, before it runs; its bytes depend on the script only."""
    cells = jupytext.read(script)
    for number, cell in enumerate(cells.cells, start=1):
        cell["id"] = f"cell-{number}"
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    cells["metadata"] = {"kernelspec": kernel}
    return cells


def executed(script: Path, folder: Path) -> NotebookNode:
    """Return the notebook of a script with its outputs; its files are written to a folder.

    Raises nbclient's CellExecutionError for the first cell that fails.
    """
    cells = notebook(script)
    NotebookClient(
        cells,
        timeout=SECONDS,
        resources={"metadata": {"path": str(folder)}},
        record_timing=False,
        coalesce_streams=True,
    ).execute()
    for output in (x for cell in cells.cells for x in cell.get("outputs", ())):
        pictures = output.get("data", {})
        if "image/png" in pictures:
            pictures["image/png"] = smaller(pictures["image/png"])
    cells.metadata.pop("language_info", None)  # it has the version of Python
    return cells


def smaller(picture: str) -> str:
    """Return a PNG (base64) with 64 colours, which takes a third of the bytes."""
    bytes_of = BytesIO()
    image = Image.open(BytesIO(base64.b64decode(picture))).convert("RGB")
    image.quantize(64).save(bytes_of, "PNG", optimize=True)
    return base64.b64encode(bytes_of.getvalue()).decode()


def main() -> None:
    """Run all scripts, or the named ones, and write their notebooks."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="such as teaching; all of them by default")
    parser.add_argument("--to", type=Path, default=GALLERY, help="the folder for the notebooks")
    arguments = parser.parse_args()
    names = arguments.names or sorted(x.stem for x in GALLERY.glob("*.py"))
    made = Path("out")
    made.mkdir(exist_ok=True)
    for name in names:
        cells = executed(GALLERY / f"{name}.py", made)
        write(cells, arguments.to / f"{name}.ipynb")


if __name__ == "__main__":
    main()
