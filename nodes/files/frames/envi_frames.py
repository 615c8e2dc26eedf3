"""Frames, or bands, of an ENVI file, one after the other (BSQ), with its header beside it."""

from __future__ import annotations

from nodes.files.frames.frame_series import FrameSeries
from nodes.files.headers.envi_header import REAL_TYPES


def envi_header_text(series: FrameSeries) -> str:
    """The header of the data file: size, type and what is known of the frames."""
    code = next(code for code, name in REAL_TYPES.items() if name == series.dtype.str[1:])
    beside = ", a band each" if series.what == "frames" else ""
    lines = [
        "ENVI",
        f"description = {{{series.what} of Imagechain{beside}}}",
        f"samples = {series.columns}",
        f"lines = {series.rows}",
        f"bands = {series.frames}",
        "header offset = 0",
        "file type = ENVI Standard",
        f"data type = {code}",
        "interleave = bsq",
        "byte order = 0",
    ]
    for key, value in series.metadata.items():
        name = "data units" if key == "unit" else key.replace("_", " ")
        text = f"{{{', '.join(map(repr, value))}}}" if isinstance(value, tuple) else str(value)
        lines.append(f"{name} = {' '.join(text.split())}")
    return "\n".join(lines) + "\n"
