"""Vibration MTF: sinusoidal line-of-sight motion."""

from typing import Any

from core.chain.wires import Context, Magnitude
from core.modules.declaration import Formula, NodeContext, param, readout
from core.physics.sampling.platform_motion import vibration_mtf
from nodes.shared.module_ports import MtfModule, MtfOutputs


class VibrationMTF(MtfModule, key="vibration_mtf", title="Vibration MTF", group="Motion"):
    """Blur by sinusoidal vibration of the line of sight.

    Over a whole number of periods, the MTF is J0(2πA·xi), where A is the amplitude. A remaining
    part of a period is integrated from phase 0 and weighted by time. Without a frequency or an
    integration time, many periods are assumed. The two axes are independent. Source: Kopeika 1998.
    """

    formulas = (
        Formula(
            r"H(\xi)=J_0(2\pi A\,\xi)",
            where="A: amplitude, mrad",
            when="for a whole number of periods, or for many periods",
        ),
        Formula(
            r"H(\xi)=\left|\frac{1}{t}\int_0^t e^{-2\pi iA\,\xi\,\sin(2\pi fs)}\,ds\right|",
            where="f: frequency, Hz; t: integration time, s",
            when="if part of a period is left over",
        ),
    )

    amplitude_x_mrad: float = param(0.0, "horizontal amplitude", low=0, slider=(0, 1))
    amplitude_y_mrad: float = param(0.0, "vertical amplitude", low=0, slider=(0, 1))
    frequency_Hz: float | None = param(None, "frequency of the vibration", low=0)
    integration_time_s: float | None = param(None, "integration time", low=0)

    def run(self, context: Context, magnitude: Magnitude, here: NodeContext) -> MtfOutputs:
        x, y = map(self._parameters, (self.amplitude_x_mrad, self.amplitude_y_mrad))
        return self.separated(magnitude, here, vibration_mtf, x=x, y=y)

    def _parameters(self, amplitude_mrad: float) -> dict[str, Any] | None:
        if amplitude_mrad == 0:
            return None
        return {
            "amplitude_mrad": amplitude_mrad,
            "vibration_frequency_Hz": self.frequency_Hz,
            "integration_time_s": self.integration_time_s,
        }

    @readout("periods")
    def periods(self) -> float | None:
        """Number of periods in one exposure; empty if many periods are assumed."""
        if self.frequency_Hz is None or self.integration_time_s is None:
            return None
        return self.frequency_Hz * self.integration_time_s
