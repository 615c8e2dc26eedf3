"""Cells of a table that only Python's own float takes for numbers."""

from __future__ import annotations

import pytest

from core.errors import FileError
from nodes.files.headers.envi import read_info
from nodes.files.path_table import read_path_table
from nodes.files.wavelength_table import read_wavelengths

SLIPS = ["0_6", "\u0660.\u0666"]  # 6 and 0.6 by float()


@pytest.mark.parametrize("slip", SLIPS)
@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("3,{}\n4,1\n", lambda file: read_wavelengths(file, what="response", low=0, high=100)),
        ("3,{},1\n4,1,1\n", read_path_table),
        (" FREQ TOT TRANS PTH THRML\n 2500 {} 1E-7\n 2600 1 1E-7\n -9999.\n", read_path_table),
    ],
)
def test_a_cell_in_pythons_own_writing_is_no_number(tmp_path, text, read, slip):
    file = tmp_path / "table.csv"
    file.write_text(text.format(slip), encoding="utf-8")
    with pytest.raises(FileError, match=r"line [12], "):
        read(file)


@pytest.mark.parametrize("slip", ["3_5", "\u0663.5"])
def test_a_wavelength_in_pythons_own_writing_is_no_number(tmp_path, slip):
    (tmp_path / "x.img").write_bytes(bytes(8))
    (tmp_path / "x.img.hdr").write_text(
        "ENVI\nsamples = 1\nlines = 1\nbands = 2\ndata type = 4\ninterleave = bsq\n"
        f"byte order = 0\nwavelength = {{3, {slip}}}\n",
        encoding="utf-8",
    )
    with pytest.raises(FileError, match="wavelength holds what is no number"):
        read_info(tmp_path / "x.img")
