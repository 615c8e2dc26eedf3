"""Parameters that several modules have alike, by their annotations."""

from __future__ import annotations

from typing import Annotated

from core.modules.parameters import Param

CutOn = Annotated[
    float | None, Param("shortest wavelength; empty: the image's band", unit="µm", low=0)
]
CutOff = Annotated[
    float | None, Param("longest wavelength; empty: the image's band", unit="µm", low=0)
]
LongestPeriod = Annotated[
    float,
    Param(
        "slowest 1/f noise: time since the last correction",
        unit="s",
        low=1e-9,
        high=1e9,
        slider=(1, 3600),
    ),
]
WeightingSource = Annotated[
    float | None,
    Param("black body that weights one band; empty: the scene's, or sunlight", unit="K", low=0,
          high=1e6, slider=(250, 6500)),
]  # fmt: skip
LightingSource = Annotated[
    float | None,
    Param("black body that lights the band; empty: the picture's mean, or sunlight", unit="K",
          low=0, high=1e6, slider=(200, 6500)),
]  # fmt: skip
