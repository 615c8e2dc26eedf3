"""Tables of numbers in text."""

import json
import random

import numpy as np
import pytest

from core.errors import FileError
from nodes.files.arrays import read_matrix
from nodes.files.curve_tables import read_motion, read_mtf_table, read_path_table, read_wavelengths
from nodes.files.formats import read_info
from nodes.files.table_cells import csv_lines, plain_cell, text_cell
from nodes.optics.mtf_file import read_listing

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
    with pytest.raises(FileError, match=r"line [12]: must contain"):
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
    matrix, *named = read_listing(path)
    np.testing.assert_array_equal(matrix, [[0.1, -0.2, 0.3], [0.1, 0.2, 0.0]])
    assert named == [0.55, None]
    path.write_bytes(TABLE.replace("\n", newline).encode(encoding))
    table = read_mtf_table(path)
    assert table.unit == "cyc/mm"
    assert table.frequencies == (0.0, 10.0, 20.0)
    assert table.columns["mtf_y"] == (1.0, 0.7, 0.2)
    assert table.columns["phase_x"] == pytest.approx(np.radians([0.0, 5.0, 9.0]))
    assert "mtf" not in table.columns


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
    assert table.columns["mtf"] == (1.0, 0.5)


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
                assert read_listing(path)[0].ndim == 2
        except FileError as error:
            refusals.append(str(error))
    assert len(refusals) > 100
    for line in refusals:
        assert "\n" not in line
        assert len(line) < 500


# As MODTRAN 4 writes it: a field of 7 or 8 for FREQ, then of 11, names at the right of their field.
HEAD = (
    "    FREQ  TOT TRANS  PTH THRML  THRML SCT  SURF EMIS   SOL SCAT  SING SCAT  GRND RFLT"
    "  DRCT RFLT  TOTAL RAD  REF SOL  SOL@OBS   DEPTH"
)
CARDS = ["TM  2    2    2    1    0    0    0    0    0    0    0    0    1", "    2000      2500"]
ROWS = [  # wavenumber, transmission, thermal, sun: W/cm²/sr per cm⁻¹
    (2000.0, 0.1234, 1.1e-7, 2.0e-9),
    (2250.0, 0.0, 2.5e-7, 3.0e-9),
    (2500.0, 1.0, 3.5e-8, 9.0e-9),
]


def row(frequency, passed, thermal, sun, *, solar=True):
    """Fields of a width; the columns of the sun are blank in thermal runs."""
    blank = " " * 11
    cells = [f"{frequency:8.0f}", f"{passed:11.4f}", f"{thermal:11.3E}", f"{0.0:11.3E}"]
    cells += [f"{1e-6:11.3E}", f"{sun:11.3E}" if solar else blank]
    cells += [f"{0.0:11.3E}" if solar else blank, f"{2e-6:11.3E}"]
    cells += [f"{0.0:11.3E}" if solar else blank, f"{9e-6:11.3E}"]
    cells += [f"{1e-7:9.2E}", f"{2e-7:9.2E}"] if solar else [" " * 18]
    return "".join([*cells, f"{0.7:8.3f}"])


def tape7(*, head=HEAD, solar=True, rows=ROWS, end=("  -9999.",)):
    return "\n".join([*CARDS, head, *(row(*r, solar=solar) for r in rows), *end]) + "\n"


def written(folder, text):
    path = folder / "path.tp7"
    path.write_text(text)
    return path


@pytest.mark.parametrize("head", [HEAD, HEAD.replace("TOT T", "TOT_T").replace("PTH T", "PTH_T")])
@pytest.mark.parametrize("solar", [True, False])
def test_tape7(tmp_path, head, solar):
    """2000 cm⁻¹ is 5 µm; per µm there are 400 cm⁻¹: L_λ = L_ν·10⁴·400 in W/m²/sr/µm."""
    transmission, radiance = read_path_table(written(tmp_path, tape7(head=head, solar=solar)))
    assert [place for place, _ in transmission] == pytest.approx([4.0, 1e4 / 2250, 5.0], rel=1e-15)
    assert [value for _, value in transmission] == [1.0, 0.0, 0.1234]
    sun = [9e-9, 3e-9, 2e-9] if solar else [0.0] * 3
    expected = [
        (3.5e-8 + sun[0]) * 1e4 * 625.0,
        (2.5e-7 + sun[1]) * 1e4 * 506.25,
        (1.1e-7 + sun[2]) * 1e4 * 400.0,
    ]
    assert [value for _, value in radiance] == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (tape7(end=()), "ends without -9999."),
        (tape7(end=("  -9999.", *CARDS, HEAD)), "several MODTRAN runs"),
        (tape7(head=HEAD.replace("PTH THRML", "         ")), "0 columns are named PTH THRML"),
        (tape7(rows=ROWS[:1]), "1 row; a spectrum needs at least 2"),
        (tape7(rows=[ROWS[1], ROWS[0]]), "line 5.*a wavenumber above the previous one"),
        (tape7(rows=[(2000.0, 1.3, 0.0, 0.0), ROWS[1]]), "line 4.*TOT TRANS from 0 to 1"),
        (tape7(rows=[(2000.0, 0.3, -1e-7, 0.0), ROWS[1]]), "line 4.*radiance of at least 0"),
        (tape7() + "", None),
        (tape7().replace("0.1234", "0,1234"), "line 4.*numbers, like all rows"),
    ],
)
def test_damaged_tape7(tmp_path, text, words):
    path = written(tmp_path, text)
    if words is None:
        assert len(read_path_table(path)[0]) == 3
        return
    with pytest.raises(FileError, match=words) as error:
        read_path_table(path)
    assert "\n" not in str(error.value)


# As MODTRAN 6 heads it: a column for each part of the path radiance.
HEAD_6 = (
    "    FREQ  TOT_TRANS   THRML_EM  THRML_SCT  SURF_EMIS  MULT_SCAT  SING_SCAT  GRND_RFLT"
    "  DRCT_RFLT  TOTAL_RAD  REF_SOL  SOL@OBS   DEPTH DIR_EM    TOA_SUN BBODY_T[K]"
)
PARTS_6 = {
    "FREQ": [2000.0, 2500.0], "TOT_TRANS": [0.5, 0.25], "THRML_EM": [1e-7, 2e-7],
    "THRML_SCT": [1e-9, 2e-9], "SURF_EMIS": [9e-6, 9e-6], "MULT_SCAT": [3e-9, 4e-9],
    "SING_SCAT": [5e-10, 6e-10], "GRND_RFLT": [8e-6, 8e-6], "TOTAL_RAD": [2e-5, 2e-5],
}  # fmt: skip
EXPECTED_6 = ((4.0, 2.066e-7 * 1e4 * 625.0), (5.0, 1.045e-7 * 1e4 * 400.0))


def json_6(parts=PARTS_6, cases=1):
    case = {"MODTRANSTATUS": {"VERSION": "6.0.2"}, "MODTRANOUTPUT": {"SPECTRA": {
        "RADIANCE": {**parts, "BBODY_TK": [280.0, 290.0]}}}}  # fmt: skip
    return json.dumps({"MODTRAN": [case] * cases}, indent=1)


def test_modtran_6_in_both_its_forms(tmp_path):
    """The path radiance is the sum of its four parts, without what comes from the surface."""
    fields = [[PARTS_6.get(name, [0.0, 0.0])[n] for name in HEAD_6.split()] for n in (0, 1)]
    rows = [f"{f[0]:8.1f}" + "".join(f"{cell:11.4E}" for cell in f[1:]) for f in fields]
    head = " " * 4 + "FREQ" + "".join(f"{name:>11}" for name in HEAD_6.split()[1:])
    for text in ("\n".join([*CARDS, head, *rows, "  -9999."]), json_6()):
        transmission, radiance = read_path_table(written(tmp_path, text))
        assert transmission == ((4.0, 0.25), (5.0, 0.5))
        assert np.array(radiance) == pytest.approx(np.array(EXPECTED_6), rel=1e-12)
    assert read_path_table(written(tmp_path, json_6({**PARTS_6, "MULT_SCAT": [0.0, 0.0]})))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (json_6(cases=2), "a single MODTRAN 6 radiance run"),
        (json_6({**PARTS_6, "FREQ": [2000.0]}), "lists of equal length"),
        (json_6({**PARTS_6, "TOT_TRANS": [0.5, None]}), "numbers, like all rows"),
        (json_6({"FREQ": [2000.0, 2500.0], "TOT_TRANS": [0.5, 0.4]}), "0 columns are named"),
        ('{"MODTRAN": [{"MODTRANINPUT": {}}]}', "under MODTRAN, MODTRANOUTPUT"),
        (json_6()[:-4], "not the JSON output"),
    ],
)
def test_damaged_json(tmp_path, text, words):
    with pytest.raises(FileError, match=words) as error:
        read_path_table(written(tmp_path, text))
    assert "\n" not in str(error.value)


def test_csv_by_names_and_without(tmp_path):
    named = (
        "# of 3 km\npath_radiance, wavelength_um, remark, transmission\n0.5,8,a,0.7\n0.6,9,b,0.8\n"
    )
    expected = ((8.0, 0.7), (9.0, 0.8)), ((8.0, 0.5), (9.0, 0.6))
    assert read_path_table(written(tmp_path, named)) == expected
    assert read_path_table(written(tmp_path, "8;0.7;0.5\n9;0.8;0.6\n")) == expected


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("8,0.7\n9,0.8\n", "line 1.*three numbers"),
        ("um,tau,L\n8,0.7,0.5\n", "0 columns are named wavelength_um"),
        ("8,1.7,0.5\n9,0.8,0.6\n", "line 1.*transmission from 0 to 1"),
        ("8,0.7,-0.5\n9,0.8,0.6\n", "path radiance of at least 0"),
        ("9,0.7,0.5\n8,0.8,0.6\n", "line 2.*above the previous one, 9"),
        ("8,0.7,0.5\n9,0.8,much\n", "line 2.*must contain numbers"),
        ("8,0.7,0.5\n", "1 point; a spectrum needs at least 2"),
        ("8,0.7,nan\n9,0.8,0.6\n", "path radiance of at least 0"),
    ],
)
def test_damaged_csv(tmp_path, text, words):
    with pytest.raises(FileError, match=words) as error:
        read_path_table(written(tmp_path, text))
    assert "\n" not in str(error.value)
