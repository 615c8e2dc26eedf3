"""The registry of picture formats: what it says holds, and nothing lists suffixes beside it."""

import ast

import numpy as np
import pytest

from child_process import ROOT
from nodes.files.file_format import CSV, HTML, JSON, SVG
from nodes.files.formats import PICTURES, WRITTEN, format_of, read_info, read_pixels, write_picture

WHOLE = np.arange(12.0).reshape(3, 4)  # exact in every type of sample
# Where a suffix may stand in the source: the formats themselves, and what networks are called.
PLACES = {
    "nodes/files/formats.py",
    "nodes/files/file_format.py",
    "nodes/files/envi_header.py",
    "nodes/optics/mtf_file.py",  # listings of lens programs, and no pictures
    "app/editor/window/files.py",
}


@pytest.mark.parametrize(
    ("suffix", "dtype"),
    [(suffix, dtype) for each in WRITTEN for suffix in each.suffixes for dtype in each.dtypes],
)
def test_each_type_of_each_format_comes_back(tmp_path, suffix, dtype):
    path = tmp_path / f"a{suffix.upper()}"
    write_picture(path, WHOLE, dtype=dtype)
    numpy_name = {"half": "float16", "float": "float32", "double": "float64"}.get(dtype, dtype)
    assert read_info(path).dtype == numpy_name
    np.testing.assert_array_equal(read_pixels(path), WHOLE)


@pytest.mark.parametrize(
    ("name", "content", "wanted"),
    [
        ("a.TIF", b"II", "tif"),
        ("a.tif", b"\x93NUMPY", "npy"),
        ("a.hdr", b"ENVI\n", "envi"),
        ("a.hdr", b"#?RADIANCE\n", "hdr"),
        ("a.img", b"\0", "envi"),
        ("beside.txt", b"1 2", "envi"),
        ("beside.tif", b"II", "tif"),
        ("a.prn", b"1 2", "text"),
        ("a.xyz", b"1 2", "other"),
        ("a", b"1 2", "other"),
    ],
)
def test_the_format_is_known_by_suffix_content_and_header(tmp_path, name, content, wanted):
    (tmp_path / "beside.hdr").write_bytes(b"ENVI\n")
    (tmp_path / name).write_bytes(content)
    assert format_of(tmp_path / name).name == wanted


def literals(path):
    """Texts of a source file but for the parts of f-strings, which make names of their own."""
    tree = ast.parse(path.read_text())
    parts = [
        part for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for part in node.values
    ]
    texts = (node for node in ast.walk(tree) if isinstance(node, ast.Constant))
    return {node.value for node in texts if isinstance(node.value, str) and node not in parts}


def test_suffixes_are_listed_nowhere_else():
    suffixes = {suffix for each in (*PICTURES, CSV, HTML, JSON, SVG) for suffix in each.suffixes}
    suffixes |= {f"*{suffix}" for suffix in suffixes}
    found = {
        f"{path.relative_to(ROOT)}: {text}"
        for layer in ("core", "nodes", "app")
        for path in (ROOT / layer).rglob("*.py")
        if str(path.relative_to(ROOT)) not in PLACES
        for text in literals(path)
        if text.lower() in suffixes or "(*." in text
    }
    networks = {"app/run/shipped.py: *.json", "app/run/preset_files.py: *.json"}
    assert found == networks  # by what they are called
