"""Reports of networks whose pictures have bands of wavelength."""

import base64
import json
import re

import numpy as np
import pytest

from command_line import run_here
from cube_network import BANDS, write_cube_network
from nodes.library import standard_library

QE = "wavelength_um,qe\n3.0,0.4\n4.0,0.8\n5.0,0.2\n"


@pytest.fixture(scope="module")
def reported(tmp_path_factory):
    """The cube, its wavelengths, the report's facts and its page."""
    folder = tmp_path_factory.mktemp("reported")
    (folder / "qe.csv").write_text(QE)
    given = {"response": "qe.csv", "cut_on_um": 3.4, "cut_off_um": 4.7}
    library = standard_library()
    cube, wavelengths, width = write_cube_network(
        folder, library, focal_plane=given, aperture_mm=100.0
    )
    reports = ("--report", "r.json", "--report", "r.html")
    done = run_here("run", "cube.json", "--tolerance", "1e-3", *reports, folder=folder)
    assert (done.returncode, done.stderr) == (0, "")
    facts = json.loads((folder / "r.json").read_text())
    return cube, wavelengths, width, facts, (folder / "r.html").read_text()


def test_the_facts(reported):
    cube, wavelengths, width, facts, _ = reported
    (one,) = facts["spectra"]["means"]  # filters change no mean
    assert one["ports"] == ["read.image", "back.image"]
    assert one["bands"] == BANDS
    assert one["band_um"] == pytest.approx([3.0, 5.0])
    assert one["centres_um"] == pytest.approx(wavelengths)
    assert one["widths_um"] == pytest.approx([width] * BANDS)
    assert one["mean"] == pytest.approx(cube.mean(axis=(1, 2)), rel=1e-9)
    assert one["unit"] == "W/m²/sr/µm"
    (response,) = facts["spectra"]["responses"]
    assert (response["node"], response["name"]) == ("fpa", "quantum efficiency")
    values = np.interp([3.3, 3.5, 4.0, 4.5], response["wavelength_um"], response["values"])
    assert values == pytest.approx([0.0, 0.6, 0.8, 0.5], abs=1e-9)


def test_the_page(reported):
    *_, page = reported
    section = page[page.index("<h2>Spectrum</h2>") :]
    section = section[: section.index("<h2>", 5)]
    picture = re.search(r'src="data:image/png;base64,([^"]*)"', section)
    assert base64.b64decode(picture[1], validate=True).startswith(b"\x89PNG")
    for words in ("read.image, back.image", "3 to 5", "W/m²/sr/µm"):
        assert words in section
