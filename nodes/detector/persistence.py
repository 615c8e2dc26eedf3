"""Persistence: the image lag of an earlier exposure."""

import numpy as np

from core.chain.step_lineage import Array, picture_step
from core.chain.wires import Image
from core.errors import DataError, ParameterError
from core.evaluation.recipes import pointwise
from core.evaluation.work import Work
from core.modules.declaration import Formula, NodeContext, param, readout
from core.physics.detector.readout import persistence
from nodes.shared.context_defaults import is_radiance
from nodes.shared.module_ports import BeforeDigits, ImageOutput


class Persistence(BeforeDigits, key="persistence", title="Persistence", group="Detector"):
    """Add image lag: a remnant of an earlier exposure that decays with two time constants.

    Connect the picture of the earlier exposure to `earlier`; both pictures must have the same size
    and unit. The shares fast_percent and slow_percent refer to the end of the earlier exposure.
    Budgets treat the lag as a fixed pattern. Source: Smith, Zavodny, Rahmer and Bonati 2008,
    Proceedings of SPIE 7021, 70210J (infrared detectors).
    """

    formulas = (
        Formula(
            r"L'=L+L_e\left(a_1e^{-t/\tau_1}+a_2e^{-t/\tau_2}\right)",
            where=(
                "L_e: the earlier picture; a, τ: share and time constant (1: fast, 2: slow); "
                "t: delay_s"
            ),
        ),
    )

    fast_percent: float = param(
        0.0, "share of the earlier picture that decays fast", (0, 100), slider=(0, 5)
    )
    fast_time_constant_s: float = param(
        1.0, "time constant of the fast share", (1e-9, 1e9), slider=(0.1, 60)
    )
    slow_percent: float = param(
        0.0, "share of the earlier picture that decays slowly", (0, 100), slider=(0, 5)
    )
    slow_time_constant_s: float = param(
        100.0, "time constant of the slow share", (1e-9, 1e9), slider=(1, 3600)
    )
    delay_s: float = param(0.0, "time since the earlier exposure", (0, 1e9), slider=(0, 600))

    def check(self) -> None:
        if self.fast_percent + self.slow_percent > 100.0 + 1e-9:  # rounding
            allowed = (
                f"slow_percent plus fast_percent ({self.fast_percent:g} %) must not exceed 100 %"
            )
            raise ParameterError("slow_percent", self.slow_percent, allowed)

    def run(self, image: Image, earlier: Image, here: NodeContext) -> ImageOutput:
        if image.shape != earlier.shape:
            raise DataError(
                f"the earlier picture has {earlier.columns} × {earlier.rows} samples and the image "
                f"has {image.columns} × {image.rows}: both must have the same size"
            )
        units = image.unit.strip(), earlier.unit.strip()
        if units[0] != units[1] and not all(map(is_radiance, units)):
            raise DataError(
                f"the earlier picture is in {units[1]!r:.40} and the image is in {units[0]!r:.40}: "
                "both must have the same unit"
            )
        if not self._share():
            return ImageOutput(image)
        lagging = here.step(with_lag, image.recipe, earlier.recipe, share=self._share())
        return ImageOutput(image.with_recipe(lagging))

    def _share(self) -> float:
        return persistence(
            shares=(self.fast_percent / 100.0, self.slow_percent / 100.0),
            time_constants_s=(self.fast_time_constant_s, self.slow_time_constant_s),
            delay_s=self.delay_s,
        )

    @readout("%")
    def lag_percent(self) -> float:
        """Share of the earlier picture that remains."""
        return 100.0 * self._share()


@picture_step(noise=lambda at, *_, **__: [at.known("persistence")])
@pointwise
def with_lag(work: Work, picture: Array, earlier: Array, *, share: float) -> Array:
    return np.asarray(picture + earlier * earlier.dtype.type(share))
