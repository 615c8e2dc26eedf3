"""Line of Sight: random motion of the sensor, within exposures and between them."""

import math
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.chain.random_fields import FrameNumber, Stream, uniform_field
from core.chain.wires import Context, Magnitude, Phase, Transfer
from core.modules.declaration import Caution, Formula, NodeContext, Section, param, readout, warning
from core.physics.sampling.platform_motion import (
    WAVES,
    MotionSpectrum,
    between_exposures_mrad,
    exposure_mtf,
    motion_waves,
    within_exposure,
)
from nodes.files.curve_tables import read_motion
from nodes.shared.deviates import SEED_SECTIONS, SeededModule
from nodes.shared.module_ports import Apply, NyquistReadouts, OtfOutputs, otf_outputs, separable

Axes = tuple[MotionSpectrum, MotionSpectrum]


class LineOfSight(
    SeededModule, NyquistReadouts, key="line_of_sight", title="Line of Sight", group="Motion"
):
    """Move the line of sight at random; the motion blurs each exposure and shifts each frame.

    The line-of-sight angle has the power spectral density S = rms²·(2/π)/(corner·(1 +
    (f/corner)²)), or the density in `psd_path` if given; the two axes are independent. Motion about
    the mean position of an exposure gives an MTF, the mean over the exposure of exp(−2π²·v(t)·ξ²).
    The mean position, with spectrum S·sinc²(fT), shifts each frame of a sequence by a phase ramp,
    −2π·ξ·shift. A single picture is frame 0 and is also shifted. 3-D Noise includes the pixel
    changes from this motion in its measurement, but not in its prediction. Sources: Papoulis 1991,
    chapter 10; Kopeika 1998, chapter 14.
    """

    formulas = (
        Formula(
            r"S(f)=\frac{2\,\sigma^2}{\pi f_c\left[1+(f/f_c)^2\right]}",
            where="σ: rms angle, mrad; f_c: corner_Hz",
            when="without psd_path",
        ),
        Formula(
            r"H(\xi)=\frac{1}{T}\int_{-T/2}^{T/2}e^{-2\pi^2v(t)\,\xi^2}\,dt",
            where="H: MTF of the motion within one exposure; T: exposure time, s",
        ),
        Formula(
            r"v(t)=\int S(f)\left[1+\mathrm{sinc}^2(fT)-2\,\mathrm{sinc}(fT)\cos(2\pi ft)"
            r"\right]df",
            where="v: variance about the mean position in the exposure, at time t from the middle "
            "of the exposure",
        ),
        Formula(
            r"\theta(\xi)=-2\pi\,\xi\,s_n,\quad s_n\sim S(f)\,\mathrm{sinc}^2(fT)",
            where="s_n: shift of frame n, mrad",
        ),
    )

    rms_x_mrad: float = param(0.0, "horizontal rms motion", (0, 1e6), slider=(0, 1))
    rms_y_mrad: float = param(0.0, "vertical rms motion", (0, 1e6), slider=(0, 1))
    corner_Hz: float = param(
        5.0,
        "frequency at which the power spectral density has fallen to half its low-frequency value",
        (1e-6, 1e9),
        slider=(0.1, 100),
    )
    psd_path: Path | None = param(
        None,
        "CSV file of frequency (Hz) and one-sided power spectral density (mrad²/Hz, horizontal "
        "and vertical); empty: calculated from rms motion and corner frequency",
    )
    integration_time_s: float = param(0.01, "exposure time", (0, 1e6), slider=(0, 0.05))
    frame_rate_Hz: float = param(30.0, "frame rate", (1e-6, 1e9), slider=(1, 120))
    apply: Apply = "multiply"

    panel = (
        Section("", "apply"),
        Section("Motion", "rms_x_mrad rms_y_mrad corner_Hz psd_path"),
        Section("Time", "integration_time_s frame_rate_Hz"),
        *SEED_SECTIONS,
    )

    def run(
        self, context: Context, magnitude: Magnitude, phase: Phase, here: NodeContext
    ) -> OtfOutputs:
        across, along = self._spectra(here)
        how: Any = {"label": self.title, "node": here.node}
        blur = separable(exposure_mtf, x=self._within(across), y=self._within(along), **how)
        x, y = self._shift(across, "shift x", here), self._shift(along, "shift y", here)
        shift = separable(frame_shift, x=x, y=y, part="ptf", **how)
        return otf_outputs(self.apply, magnitude, phase, blur=blur, shift=shift, label=self.title)

    def _spectra(self, here: NodeContext) -> Axes:
        if self.psd_path is not None:
            across, along = read_motion(here.folder / self.psd_path)
            return MotionSpectrum(points=across), MotionSpectrum(points=along)
        x, y = (MotionSpectrum(r, self.corner_Hz) for r in (self.rms_x_mrad, self.rms_y_mrad))
        return x, y

    def _within(self, spectrum: MotionSpectrum) -> dict[str, Any] | None:
        if spectrum.still or not self.integration_time_s:
            return None
        variances, weights = within_exposure(spectrum=spectrum, exposure_s=self.integration_time_s)
        return {"variances": variances, "weights": weights}

    def _shift(
        self, spectrum: MotionSpectrum, name: str, here: NodeContext
    ) -> dict[str, Any] | None:
        if spectrum.still:
            return None
        return {
            "spectrum": spectrum,
            "exposure_s": self.integration_time_s,
            "stream": self.stream(here, name, fixed=True),
            "number": FrameNumber(),
            "frame_s": 1.0 / self.frame_rate_Hz,
        }

    @warning
    def exposure(self) -> Caution | None:
        """The exposure is longer than the frame period."""
        frame_s = 1.0 / self.frame_rate_Hz
        if self.integration_time_s <= frame_s * (1 + 1e-9):
            return None
        return Caution(
            f"exposures overlap: integration_time_s = {self.integration_time_s:g} s is longer than "
            f"the frame period of {frame_s:g} s",
            "lower integration_time_s or frame_rate_Hz; ignore this warning if the "
            "frames are overlapping averages",
        )

    @readout("mrad")
    def within_x_mrad(self, axis: str, outputs: OtfOutputs) -> float:
        """Horizontal rms motion within an exposure, about the mean position."""
        bound = _bound(outputs.mtf, axis)
        return math.sqrt(float(np.dot(bound["variances"], bound["weights"]))) if bound else 0.0

    @readout("mrad")
    def between_x_mrad(self, axis: str, outputs: OtfOutputs) -> float:
        """Horizontal rms shift of a frame."""
        bound = _bound(outputs.ptf, axis)
        if not bound:
            return 0.0
        return between_exposures_mrad(spectrum=bound["spectrum"], exposure_s=bound["exposure_s"])

    @readout("mrad")
    def shift_x_mrad(self, axis: str, outputs: OtfOutputs) -> float:
        """Horizontal shift of frame 0."""
        bound = _bound(outputs.ptf, axis)
        return shift_of_frame_mrad(**bound) if bound else 0.0


def _bound(transfer: Transfer, axis: str) -> dict[str, Any]:
    """What is bound in the law of an axis; nothing where there is none."""
    laws = [getattr(factor, axis, None) for factor in transfer.factors]
    return dict(laws[0].parameters) if laws and laws[0] is not None else {}


@lru_cache(maxsize=32)
def _waves(spectrum: MotionSpectrum, exposure_s: float, stream: Stream) -> Callable[[float], float]:
    uniform = uniform_field(stream, (3, WAVES))
    return motion_waves(spectrum=spectrum, exposure_s=exposure_s, uniform=uniform)


def shift_of_frame_mrad(
    spectrum: MotionSpectrum, exposure_s: float, stream: Stream, number: FrameNumber, frame_s: float
) -> float:
    return _waves(spectrum, exposure_s, stream)(number.frame * frame_s)


def frame_shift(*, frequency: NDArray[Any], **how: Any) -> NDArray[np.float64]:
    return np.asarray(-2.0 * np.pi * shift_of_frame_mrad(**how) * np.asarray(frequency))
