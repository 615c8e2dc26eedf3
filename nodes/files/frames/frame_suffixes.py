"""What names of files of frames end in."""

from __future__ import annotations

from nodes.files.common.file_format import Format

ENVI_FRAMES = Format("bsq", (".bsq", ".img"), "ENVI BSQ")
TIFF_FRAMES = Format("tif", (".tif", ".tiff"), "multi-page TIFF")
