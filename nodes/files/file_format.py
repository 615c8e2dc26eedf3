"""What a format of files is, and those of curves, tables and reports."""

from pathlib import Path

from core.records import dataclass


@dataclass(frozen=True)
class Format:
    """A format of files: a word, suffixes in lower case, the usual one first, a description."""

    name: str
    suffixes: tuple[str, ...]
    description: str

    def matches(self, path: Path) -> bool:
        return path.suffix.lower() in self.suffixes


CSV = Format("csv", (".csv",), "numbers separated by commas")
ENVI_FRAMES = Format("bsq", (".bsq", ".img"), "ENVI BSQ")
ZARR = Format("zarr", (".zarr",), "Zarr")
BLANKS = Format("txt", (".txt", ".prn"), "numbers separated by spaces")
PNG = Format("png", (".png",), "PNG")  # for who writes none: its writer takes numpy to load
JSON = Format("json", (".json",), "JSON")
HTML = Format("html", (".html",), "page")
SVG = Format("svg", (".svg",), "drawing")
PARQUET = Format("parquet", (".parquet",), "Parquet")
NETCDF = Format("netcdf", (".nc",), "netCDF")


def suffixes(*formats: Format) -> tuple[str, ...]:
    return tuple(suffix for file_format in formats for suffix in file_format.suffixes)


def dialog_filter(title: str, *formats: Format) -> str:
    return f"{title} ({' '.join('*' + suffix for suffix in suffixes(*formats))})"
