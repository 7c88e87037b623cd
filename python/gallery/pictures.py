"""Pictures of the gallery. They are shown, or written to the folder `EMMY_GALLERY` if that is set."""

import io
import os
import re
from pathlib import Path
from typing import Any

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from cycler import cycler

FOLDER = os.environ.get("EMMY_GALLERY")
if FOLDER:
    matplotlib.use("Agg")
# A fixed salt: the same figure is the same file.
matplotlib.rcParams.update({
    "svg.hashsalt": "emmy", "font.size": 9.0, "axes.spines.top": False, "axes.spines.right": False,
    "axes.prop_cycle": cycler(color=["#1f77b4", "#d95f02", "#1b9e77", "#7570b3"]),
    "axes.formatter.use_mathtext": True, "legend.frameon": False, "lines.linewidth": 1.3, "figure.autolayout": True,
})  # fmt: skip


def finish(figure: Any, name: str) -> None:
    """Shows a figure of Matplotlib, or writes it as SVG."""
    if FOLDER is None:
        plt.show()
    else:
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None})
        plt.close(figure)
        # A hundredth of a point is enough.
        short = re.sub(
            r' (d|x|y)="[^"]*"',
            lambda own: re.sub(r"-?\d+\.\d{3,}", lambda number: f"{float(number[0]):.2f}", own[0]),
            text.getvalue(),
        )
        (Path(FOLDER) / f"{name}.svg").write_text(short, encoding="utf-8")


def plotter(**arguments: Any) -> Any:
    """A plotter of PyVista."""
    import pyvista

    return pyvista.Plotter(off_screen=FOLDER is not None, border=False, **arguments)


def screenshot(plotter: Any, name: str) -> None:
    """Shows a plotter of PyVista, or writes its picture as PNG, cropped to what is drawn."""
    if FOLDER is None:
        plotter.show()
        return
    from PIL import Image

    pixels = plotter.screenshot(return_img=True)
    rows, columns = np.nonzero((pixels < 250).any(axis=2))
    part = pixels[max(rows.min() - 8, 0) : rows.max() + 9, max(columns.min() - 8, 0) : columns.max() + 9]
    image = Image.fromarray(np.ascontiguousarray(part)).quantize(255, dither=Image.Dither.NONE)
    image.save(Path(FOLDER) / f"{name}.png", optimize=True)
    plotter.close()
