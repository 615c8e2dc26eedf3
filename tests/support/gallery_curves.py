"""The curves on the gallery's cards, as the networks give them.

    PYTHONPATH=.:tests/support python tests/support/gallery_curves.py

writes them anew: a network's curves by its name, each the number of its colour and a list of points
in thousandths of the card's drawing, x to the right and y upwards.
"""

import json

import numpy as np

import imagechain as ic
from child_process import ROOT

FILE = ROOT / "networks" / "pictures" / "gallery_curves.json"
SIDE = 1000
POINTS = 60

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


def curves_of(name):
    """A network's curves, computed."""
    if name == CUBE:
        return scaled(spectra())
    result = ic.open(name).run()
    lines = []
    for source in SOURCES[name]:
        port, _, wanted = source.partition(":")
        value = result.value(port)
        for number, series in enumerate(value.series):
            if wanted in ("", series.label):
                x, y = np.asarray(series.x), np.asarray(series.y)
                y = np.log(np.maximum(y, 1e-12)) if value.log_y else y
                made = bars(y, number, len(value.series)) if value.bars else [thinned(x, y)]
                colour = number if value.bars or not wanted else len(lines)
                lines += [(colour, *line) for line in made]
    return scaled(lines)


def spectra():
    """The cube's mean spectrum, and what of it passes the air."""
    folder = ROOT / "networks" / "cubes"
    mean = np.fromfile(folder / "scene.img", np.uint16).reshape(-1, BANDS).mean(axis=0)
    air = np.genfromtxt(folder / "air_4km.csv", delimiter=",")[1:]  # below its headings
    wavelength = 3.0625 + 0.125 * np.arange(BANDS)
    return [
        (0, wavelength, mean),
        (1, wavelength, mean * np.interp(wavelength, air[:, 0], air[:, 1])),
    ]


def bars(heights, number, of):
    """The outlines of bars that stand on zero."""
    width = 0.8 / of
    lefts = np.arange(len(heights)) + number * width
    return [
        (np.array([left, left, left + 0.9 * width, left + 0.9 * width]), np.array([0, h, h, 0]))
        for left, h in zip(lefts, heights, strict=True)
    ]


def thinned(x, y):
    """A curve of few points; peaks narrower than their distance are lost."""
    if len(x) <= POINTS:
        return x, y
    at = np.linspace(x[0], x[-1], POINTS)
    return at, np.interp(at, x, y)


def scaled(lines):
    """All curves in one square."""
    left, right = (pick([pick(x) for _, x, _ in lines]) for pick in (min, max))
    low, high = (pick([pick(y) for *_, y in lines]) for pick in (min, max))
    return [
        [
            colour,
            [
                [round(SIDE * (a - left) / (right - left)), round(SIDE * (b - low) / (high - low))]
                for a, b in zip(x, y, strict=True)
            ],
        ]
        for colour, x, y in lines
    ]


def main():
    """Write the file, a curve a line."""
    entries = []
    for name in sorted((*SOURCES, CUBE)):
        lines = ",\n    ".join(json.dumps(line, separators=(",", ":")) for line in curves_of(name))
        entries.append(f'  "{name}": [\n    {lines}\n  ]')
    FILE.write_text("{\n" + ",\n".join(entries) + "\n}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
