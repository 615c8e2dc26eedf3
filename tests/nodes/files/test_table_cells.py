"""Cells of a table that only Python's own float takes for numbers."""

from __future__ import annotations

import pytest

from core.errors import FileError
from nodes.files.arrays import read_matrix
from nodes.files.common.table_cells import csv_lines, plain_cell, text_cell
from nodes.files.lens_samples import read_listing
from nodes.files.mtf_table import read_mtf_table
from nodes.files.read import read_info
from nodes.files.spectrum_tables import read_motion, read_path_table, read_wavelengths

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
    with pytest.raises(FileError, match=r"line [12]: must be"):
        read(file)


FORMULAS = ["=1+2", "+cmd", "-x", "@sum", "\tx", "\r=1", '=HYPERLINK("http://a")']


@pytest.mark.parametrize("text", FORMULAS)
def test_text_that_a_spreadsheet_would_run_is_written_as_text(text):
    assert text_cell(text) == f"'{text}"
    assert plain_cell(f"'{text}") == text
    assert csv_lines([("a", text)]).count("'") == 1


SECRET = "zebra:$6$salt$hash:19000:0:99999:7:::"


@pytest.mark.parametrize("start", ["", "frequency (cyc/mm),mtf\n", "0,1\n", "1 2\n3 4\n"])
@pytest.mark.parametrize(
    "read",
    [
        read_mtf_table,
        read_listing,
        read_path_table,
        read_matrix,
        read_info,
        read_motion,
        lambda file: read_wavelengths(file, what="response", low=0, high=100),
    ],
)
def test_text_of_a_file_is_not_quoted(tmp_path, read, start):
    """A network of another person may name any file that the user can read."""
    file = tmp_path / "secret.txt"
    file.write_text(f"{start}{SECRET}\n{SECRET}\n")
    with pytest.raises(FileError) as refusal:
        read(file)
    assert not any(part in str(refusal.value) for part in ("zebra", "salt", "hash", "19000"))
    assert str(file) in str(refusal.value)


@pytest.mark.parametrize(
    "key",
    ["lines", "interleave", "byte order", "file type", "header offset", "data type", "fov x",
     "data ignore value", "file compression", "minor frame offsets", "wavelength", "fwhm", "bbl",
     "data gain values"],
)  # fmt: skip
@pytest.mark.parametrize("text", ["x" * 5000, "{" + "x, " * 2000 + "}"])
def test_errors_of_envi_headers_are_short(tmp_path, key, text):
    fields = {"samples": 1, "lines": 1, "bands": 1, "data type": 1, "interleave": "bsq"}
    lines = [f"{name} = {value}" for name, value in {**fields, key: text}.items()]
    (tmp_path / "a.img").write_bytes(b"1")
    (tmp_path / "a.img.hdr").write_text("\n".join(["ENVI", *lines]))
    with pytest.raises(FileError) as refusal:
        read_info(tmp_path / "a.img")
    assert len(str(refusal.value)) < 400 + len(str(tmp_path))
