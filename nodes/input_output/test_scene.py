"""Test Scene: radiometric targets and the built-in dormitory."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.declaration import Here, Module
from core.errors import ParameterError
from core.parameters import Param
from core.physics.sampling import interval_mrad
from core.recipes import Step
from core.values import Header, Image
from core.work import Work
from nodes.ports import ImageOutput
from nodes.scenes.draw import draw_scene

Kind = Literal[
    "dormitory",
    "slanted_edge",
    "four_bar",
    "siemens_star",
    "point",
    "sine",
    "two_panel",
    "uniform",
]


class TestScene(Module, key="test_scene", title="Test Scene", group="Input and output"):
    """Draw a radiometric test scene.

    Temperatures and emissivities become band radiance through Planck's law; edges are
    area-sampled, not aliased. The dormitory is a building front with windows, warm and cool, sky
    and ground.
    """

    __test__ = False  # not a test class, whatever its name says

    kind: Annotated[Kind, Param("what to draw")] = "dormitory"
    width: Annotated[int, Param("samples across", low=1, high=65536, slider=(16, 2048))] = 512
    height: Annotated[int, Param("samples along", low=1, high=65536, slider=(16, 2048))] = 512
    fov_x_deg: Annotated[
        float | None,
        Param("field of view across", unit="deg", low=0, high=180, below=True),
    ] = 30.0
    fov_y_deg: Annotated[
        float | None,
        Param("field of view along", unit="deg", low=0, high=180, below=True),
    ] = 30.0
    cut_on_um: Annotated[float, Param("shortest wavelength", unit="µm", low=0, above=True)] = 8.0
    cut_off_um: Annotated[float, Param("longest wavelength", unit="µm", low=0, above=True)] = 12.0
    temperature_K: Annotated[
        float, Param("background temperature", unit="K", low=0, above=True, slider=(200, 400))
    ] = 303.15
    delta_K: Annotated[
        float, Param("how much warmer the target is", unit="K", slider=(-50, 50))
    ] = 10.0
    angle_deg: Annotated[
        float, Param("direction of an edge's normal or a wave", unit="deg", slider=(-90, 90))
    ] = 5.0
    frequency: Annotated[
        float, Param("cycles across the frame, or spokes of the star", low=0, above=True)
    ] = 16.0

    def check(self) -> None:
        """Refuse an empty band and temperatures below zero."""
        if self.cut_on_um >= self.cut_off_um:
            raise ParameterError(
                "cut_off_um", self.cut_off_um, f"above cut_on_um = {self.cut_on_um:g}", unit="µm"
            )
        if self.temperature_K + self.delta_K <= 0:
            raise ParameterError(
                "delta_K", self.delta_K, f"above −temperature_K = −{self.temperature_K:g}", unit="K"
            )

    def run(self, here: Here) -> ImageOutput:
        """Plan the picture."""
        values = {k: v for k, v in self.values().items() if k not in ("fov_x_deg", "fov_y_deg")}
        recipe = Step.of(drawn, node=here.node, **values)
        x, y = self.fov_x_deg, self.fov_y_deg
        return ImageOutput(
            Image(
                recipe,
                self.height,
                self.width,
                None if x is None else interval_mrad(fov_deg=x, samples=self.width),
                None if y is None else interval_mrad(fov_deg=y, samples=self.height),
                band_um=(self.cut_on_um, self.cut_off_um),
                header=Header(fov_x_deg=x, fov_y_deg=y),
            )
        )


def drawn(work: Work, **values: Any) -> NDArray[np.floating]:
    """The scene's samples in the evaluation's precision."""
    return draw_scene(dtype=work.policy.dtype, **values)
