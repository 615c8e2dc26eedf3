"""MTFs of smear by scan and platform, and of vibration."""

from typing import Any, Literal

from core.chain.wires import Context, Magnitude
from core.modules.declaration import Formula, NodeContext, Section, param, readout
from core.physics.sampling import platform_motion
from core.transfer.factors import Law, Planar
from nodes.shared.context_defaults import context_warning, given
from nodes.shared.module_ports import MtfModule, MtfOutputs


class CrosstrackMTF(MtfModule, key="crosstrack_mtf", title="Crosstrack MTF", group="Motion"):
    """Blur across the track by the scan during one dwell time.

    The MTF is sinc(v·t·ξ). A dwell time of 0 gives no smear. Source: Tantalo 1996, section 4.4.1;
    the thesis neglects this smear.
    """

    formulas = (
        Formula(
            r"H(\xi)=\mathrm{sinc}(v\,t\,\xi)",
            where="v: scan velocity, mrad/s; t: dwell time, s; sinc(x) = sin(πx)/(πx)",
        ),
    )

    dwell_time_s: float = param(0.0, "dwell time of one sample", low=0)
    scan_velocity_mrad_per_s: float | None = param(
        None, "scan velocity; empty: from Init & Trans", low=0
    )

    def run(self, context: Context, magnitude: Magnitude, here: NodeContext) -> MtfOutputs:
        blur = self.blur_mrad(context)
        x = {"blur_mrad": blur} if blur else None
        return self.separated(magnitude, here, platform_motion.motion_mtf, x=x)

    velocity = context_warning(
        "The scan velocity differs from the value on Init & Trans.", "scan_velocity_mrad_per_s"
    )

    @readout("mrad")
    def blur_mrad(self, context: Context) -> float:
        """Width of the smear across the track."""
        name = "scan_velocity_mrad_per_s"
        velocity = given(name, self.scan_velocity_mrad_per_s, context)
        return platform_motion.scan_blur_mrad(
            scan_velocity_mrad_per_s=velocity, dwell_time_s=self.dwell_time_s
        )


class AlongtrackMTF(MtfModule, key="alongtrack_mtf", title="Alongtrack MTF", group="Motion"):
    """Blur along the track by the platform's forward motion while a sample is collected.

    The MTF is sinc(b·η) with b = velocity·time/range. Source: Tantalo 1996, eqs. 4.24 to 4.28.
    Erratum: the width 134 in eq. 4.28 is in cycles/rad, not cycles/mrad.
    """

    formulas = (
        Formula(
            r"H(\eta)=\mathrm{sinc}(b\,\eta),\quad b=\frac{1000\,v\,t}{R}",
            where="b: blur, mrad; v: velocity, m/s; t: integration time, s; R: range, m",
        ),
    )

    velocity_m_per_s: float | None = param(
        None, "velocity of the platform; empty: from Init & Trans"
    )
    integration_time_s: float = param(0.0, "integration time", low=0)
    range_m: float | None = param(
        None, "altitude, or distance to the scene; empty: from Init & Trans", low=0
    )

    def run(self, context: Context, magnitude: Magnitude, here: NodeContext) -> MtfOutputs:
        blur = self.blur_y_mrad(context)
        y = {"blur_mrad": blur} if blur else None
        return self.separated(magnitude, here, platform_motion.motion_mtf, y=y)

    distance = context_warning("The range differs from the value on Init & Trans.", "range_m")
    velocity = context_warning(
        "The velocity differs from the value on Init & Trans.", "velocity_m_per_s"
    )

    @readout("mrad")
    def blur_y_mrad(self, context: Context) -> float:
        """Width of the smear along the track."""
        return _smear_mrad(self, given("velocity_m_per_s", self.velocity_m_per_s, context), context)


class RelativeMotionMTF(
    MtfModule, key="relative_motion_mtf", title="Relative Motion MTF", group="Motion"
):
    """Blur by the relative velocity of platform and image while the detector integrates.

    `published` is the product sinc(bx·ξ)·sinc(by·η), a rectangle (eq. 4.31). `line` is
    sinc(bx·ξ + by·η), the straight smear at constant velocity. A relative velocity of zero gives
    an MTF of exactly 1. Source: Tantalo 1996, eqs. 4.29 to 4.35. Erratum: the widths 160 and 201 in
    eqs. 4.34 and 4.35 are in cycles/rad, not cycles/mrad.
    """

    formulas = (
        Formula(
            r"H=\mathrm{sinc}(b_x\xi)\,\mathrm{sinc}(b_y\eta)",
            where="b: 1000·(platform velocity − image velocity)·time/range, mrad",
            when="published",
        ),
        Formula(
            r"H=\mathrm{sinc}(b_x\xi+b_y\eta)",
            where="for a straight smear at constant velocity",
            when="line",
        ),
    )

    image_velocity_x: float = param(0.0, "velocity of the image along x", unit="m/s")
    image_velocity_y: float = param(0.0, "velocity of the image along y", unit="m/s")
    platform_velocity_x: float = param(0.0, "velocity of the platform along x", unit="m/s")
    platform_velocity_y: float = param(0.0, "velocity of the platform along y", unit="m/s")
    integration_time_s: float = param(0.0, "integration time", low=0)
    range_m: float | None = param(None, "distance to the scene; empty: from Init & Trans", low=0)
    model: Literal["published", "line"] = param(
        "published", "shape of the smear: rectangle (Tantalo's eq. 4.31), or straight line"
    )

    panel = (
        Section("", "apply"),
        Section("Image", "image_velocity_x image_velocity_y"),
        Section("Platform", "platform_velocity_x platform_velocity_y"),
        Section("Smear", "integration_time_s range_m model"),
    )

    def run(self, context: Context, magnitude: Magnitude, here: NodeContext) -> MtfOutputs:
        x, y = self.blur_x_mrad("x", context), self.blur_x_mrad("y", context)
        if self.model == "line" and x and y:
            law = Law.of(platform_motion.line_motion_mtf, blur_x_mrad=x, blur_y_mrad=y)
            smear = Planar(law, symmetric=False, label=self.title, node=here.node)
            return self.mtf_outputs(magnitude, smear)
        across, along = ({"blur_mrad": blur} if blur else None for blur in (x, y))
        return self.separated(magnitude, here, platform_motion.motion_mtf, x=across, y=along)

    distance = context_warning("The range differs from the value on Init & Trans.", "range_m")

    @readout("mrad")
    def blur_x_mrad(self, axis: str, context: Context) -> float:
        """Signed width of the horizontal smear."""
        platform, image = f"platform_velocity_{axis}", f"image_velocity_{axis}"
        return _smear_mrad(self, getattr(self, platform) - getattr(self, image), context)


def _smear_mrad(
    module: AlongtrackMTF | RelativeMotionMTF, velocity_m_per_s: float, context: Context
) -> float:
    if velocity_m_per_s == 0 or module.integration_time_s == 0:
        return 0.0
    return platform_motion.blur_mrad(
        velocity_m_per_s=velocity_m_per_s,
        time_s=module.integration_time_s,
        range_m=given("range_m", module.range_m, context),
    )


class VibrationMTF(MtfModule, key="vibration_mtf", title="Vibration MTF", group="Motion"):
    """Blur by sinusoidal vibration of the line of sight.

    Over a whole number of periods, the MTF is J0(2πA·ξ), where A is the amplitude. A remaining
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
        return self.separated(magnitude, here, platform_motion.vibration_mtf, x=x, y=y)

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
