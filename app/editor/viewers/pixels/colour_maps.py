"""Colour maps of pictures, as tables of 256 colours."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from types import MappingProxyType

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray

Table = NDArray[np.uint8]

NAMES: Mapping[str, str] = MappingProxyType(
    {
        "grey": "Grey",
        "inverted": "Grey inverted",
        "viridis": "Viridis",
        "inferno": "Inferno",
        "magma": "Magma",
        "turbo": "Turbo",
        "diverging": "Blue–white–red",
    }
)
_FILES = MappingProxyType({"diverging": "CET-D1"})


@cache
def colour_table(name: str) -> Table:
    """Red, green and blue of the 256 levels, shape (256, 3)."""
    ramp = np.arange(256, dtype=np.uint8)
    if name in ("grey", "inverted"):
        ramp = ramp if name == "grey" else ramp[::-1]
        return np.repeat(ramp[:, np.newaxis], 3, axis=1)
    colours = pg.colormap.get(_FILES.get(name, name)).getLookupTable(nPts=256, alpha=False)
    return np.ascontiguousarray(colours, np.uint8)


def colour_map(name: str) -> pg.ColorMap:
    """As pyqtgraph's items take it."""
    return pg.ColorMap(None, colour_table(name)[::15])
