"""Texts of lenses, whole and damaged: numbers, or one clear line."""

from __future__ import annotations

import random

import numpy as np
import pytest

from core.errors import FileError
from nodes.files.lens_samples import read_listing
from nodes.files.mtf_table import read_mtf_table

TABLE = "frequency (cyc/mm),mtf_x,mtf_y,phase_x (deg)\n0,1,1,0\n10,0.8,0.7,5\n20,0.3,0.2,9\n"
LISTING = (
    "Listing of Wavefront Map Data\n\n0.5500 µm at 0.0000 (deg).\nPupil grid size: 3 by 2\n"
    "Center point is: 2, 2\n\n 0.1E+000\t-2.0E-001\t 3.0E-001\n 1.0E-001\t 2.0E-001\t 0.0E+000\n"
)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "latin-1"])
@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_every_encoding_and_line_end(tmp_path, encoding, newline):
    path = tmp_path / "a.txt"
    path.write_bytes(LISTING.replace("\n", newline).encode(encoding))
    listing = read_listing(path)
    np.testing.assert_array_equal(listing.matrix, [[0.1, -0.2, 0.3], [0.1, 0.2, 0.0]])
    assert listing.wavelength_um == 0.55
    assert listing.spacing_um is None
    path.write_bytes(TABLE.replace("\n", newline).encode(encoding))
    table = read_mtf_table(path)
    assert table.unit == "cyc/mm"
    assert table.frequencies == (0.0, 10.0, 20.0)
    assert table.column("mtf_y") == (1.0, 0.7, 0.2)
    assert table.column("phase_x") == pytest.approx(np.radians([0.0, 5.0, 9.0]))
    assert table.column("mtf") is None


@pytest.mark.parametrize(
    "heading",
    [
        "frequency (cyc/mm),mtf", "Frequency [lp/mm];MTF", "frequency_cyc_per_mm mtf",
        "Spatial Frequency (cycles per mm)\tMTF", '"frequency (c/mm)","mtf"', "frequency(1/mm),mtf",
    ],
)  # fmt: skip
def test_ways_to_name_the_columns(tmp_path, heading):
    mark = next((sign for sign in ",;\t" if sign in heading), " ")
    path = tmp_path / "a.csv"
    path.write_text(f"# a lens\n{heading}\n0{mark}1\n\n5{mark}0.5\n", encoding="utf-8")
    table = read_mtf_table(path)
    assert table.unit == "cyc/mm"
    assert table.column("mtf") == (1.0, 0.5)


@pytest.mark.parametrize("text", [TABLE, LISTING], ids=["table", "listing"])
def test_damage_is_one_clear_line(tmp_path, text):
    """Bytes changed, cut out and put in anywhere: what is read then is finite, or NaN in a map."""
    draw = random.Random(5)
    path = tmp_path / "a.txt"
    refusals = []
    for number in range(400):
        content = bytearray(text.encode(draw.choice(["utf-8", "utf-16"])))
        for _ in range(draw.randint(1, 4)):
            place = draw.randrange(len(content))
            content[place : place + draw.choice([0, 1, 1, 7])] = draw.randbytes(draw.randint(0, 3))
        path.write_bytes(bytes(content) + b" " * number)  # of another size: another file
        try:
            if text is TABLE:
                table = read_mtf_table(path)
                assert np.isfinite([table.frequencies, *dict(table.columns).values()]).all()
            else:
                assert read_listing(path).matrix.ndim == 2
        except FileError as error:
            refusals.append(str(error))
    assert len(refusals) > 100
    for line in refusals:
        assert "\n" not in line
        assert len(line) < 500
