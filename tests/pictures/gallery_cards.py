"""The cards of networks whose curves say more than their picture.

    PYTHONPATH=.:tests/support python tests/pictures/gallery_cards.py

writes them anew, as networks/pictures/card_NETWORK.png.
"""

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

import imagechain as ic
from child_process import ROOT

FOLDER = ROOT / "networks" / "pictures"
BACKGROUND, COLOURS = "#1d2126", ("#6cb4ff", "#ffb454", "#7bd88f", "#ff7a8a", "#c79bff", "#8fd7e0")

# The curve outputs drawn, and which of their series: all of an output without a colon.
SOURCES = {
    "microbolometer": ("merit.probability",),
    "figures_of_merit": ("merit.mrtd:2-D",),
    "noise_budget": ("budget.noise",),
    "measured_mtf": ("measured.curve",),
    "pupils": tuple(
        f"{name}_slices.curve:Total MTF" for name in ("clear", "half_moon", "cassegrain", "hinged")
    ),
    "line_by_line": ("lines.curve:largest", "lines.curve:rms"),
    "spatial_blur": ("space.curve",),
    "inframetrics_1996": ("slices.curve",),
    "kodak_kir310_1996": ("slices.curve",),
}
CUBE, BANDS = "dirsig_cube", 16


def spectra():
    """The cube's mean spectrum, and what of it passes the air."""
    folder = ROOT / "networks" / "cubes"
    mean = np.fromfile(folder / "scene.img", np.uint16).reshape(-1, BANDS).mean(axis=0)
    air = np.genfromtxt(folder / "air_4km.csv", delimiter=",")[1:]  # below its headings
    wavelength = 3.0625 + 0.125 * np.arange(BANDS)
    return [(wavelength, mean), (wavelength, mean * np.interp(wavelength, air[:, 0], air[:, 1]))]


def draw(name, axes):
    """A network's curves, as it gives them."""
    if name == CUBE:
        for (x, y), colour in zip(spectra(), COLOURS, strict=False):
            axes.plot(x, y, color=colour)
        return
    result, number = ic.open(name).run(), 0
    for source in SOURCES[name]:
        port, _, wanted = source.partition(":")
        value = result.value(port)
        for series in value.series:
            if wanted not in ("", series.label):
                continue
            colour = COLOURS[number % len(COLOURS)]
            if value.bars:
                width = 0.8 / len(value.series)
                axes.bar(np.arange(len(series.y)) + number * width, series.y, width, color=colour)
            else:
                axes.plot(series.x, series.y, color=colour)
            number += 1
        if value.log_y and not value.bars:
            axes.set_yscale("log")


def main():
    """Write every card."""
    for name in (*SOURCES, CUBE):
        figure = Figure(figsize=(2.8, 2.0), dpi=100, facecolor=BACKGROUND)
        axes = figure.add_axes((0.06, 0.08, 0.88, 0.84), facecolor=BACKGROUND)
        axes.axis("off")
        draw(name, axes)
        FigureCanvasAgg(figure)
        figure.savefig(FOLDER / f"card_{name}.png")


if __name__ == "__main__":
    main()
