"""The cube that comes with the network `dirsig_cube`, made anew.

    python tests/support/shipped_cube.py FOLDER

writes scene.img and its header there: the Test Scene by day, in whole milliwatts.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

ROWS, COLUMNS, BANDS = 160, 192, 16
LOW_UM, HIGH_UM = 3.0, 5.0
LIGHT = {
    "temperature_K": 293.15,
    "delta_K": 6.0,
    "emissivity": "spectra",
    "sun_elevation_deg": 40.0,
}
UNIT_PER_W = 1000.0
HEADER = """ENVI
description = {{Imagechain's Test Scene by day, stored as DIRSIG stores its scenes}}
samples = {columns}
lines = {rows}
bands = {bands}
header offset = 0
file type = ENVI Standard
data type = 12
interleave = bip
byte order = 0
data units = mW/m^2/sr/um
wavelength units = Micrometers
wavelength = {{{centres}}}
fwhm = {{{widths}}}
"""


def samples():
    """Milliwatts, (rows, columns, bands), as they are stored."""
    from nodes.scenes.draw import draw_shares, scene_spectra, show_radiances
    from nodes.scenes.scene_canvas import Canvas

    shares = draw_shares("dormitory", Canvas(COLUMNS, ROWS, np.float64))
    spectra = scene_spectra(
        kind="dormitory", cut_on_um=LOW_UM, cut_off_um=HIGH_UM, bands=BANDS, **LIGHT
    )
    bands = [
        show_radiances(shares, {name: values[band] for name, values in spectra.items()})
        for band in range(BANDS)
    ]
    return np.rint(UNIT_PER_W * np.stack(bands, axis=2)).astype("<u2")


def header():
    """The text of the header."""
    width = (HIGH_UM - LOW_UM) / BANDS
    centres = [f"{LOW_UM + (band + 0.5) * width:g}" for band in range(BANDS)]
    return HEADER.format(
        rows=ROWS,
        columns=COLUMNS,
        bands=BANDS,
        centres=", ".join(centres),
        widths=", ".join([f"{width:g}"] * BANDS),
    )


def main(folder):
    """Write both files."""
    samples().tofile(folder / "scene.img")
    (folder / "scene.img.hdr").write_text(header(), encoding="utf-8")


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
    main(Path(sys.argv[1]))
