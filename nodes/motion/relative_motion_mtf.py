"""Relative Motion MTF: smear by image and platform moving differently."""

from typing import Literal

from core.chain.wires import Context, Magnitude
from core.modules.declaration import Caution, Formula, NodeContext, Section, param, readout, warning
from core.physics.sampling.platform_motion import blur_mrad, line_motion_mtf, motion_mtf
from core.transfer.factors import Law, Planar
from nodes.shared.context_defaults import apart_from_context, given
from nodes.shared.module_ports import MtfModule, MtfOutputs


class RelativeMotionMTF(
    MtfModule, key="relative_motion_mtf", title="Relative Motion MTF", group="Motion"
):
    """Smear from the relative velocity of platform and image while the detector integrates.

    `published` is the product sinc(bx·xi)·sinc(by·eta), a rectangle (eq. 4.31). `line` is
    sinc(bx·xi + by·eta), the straight smear at constant velocity. A relative velocity of zero gives
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
        "published", "rectangle (eq. 4.31), or a straight smear"
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
            law = Law.of(line_motion_mtf, blur_x_mrad=x, blur_y_mrad=y)
            smear = Planar(law, symmetric=False, label=self.title, node=here.node)
            return self.mtf_outputs(magnitude, smear)
        across, along = ({"blur_mrad": blur} if blur else None for blur in (x, y))
        return self.separated(magnitude, here, motion_mtf, x=across, y=along)

    @warning
    def distance(self, context: Context) -> Caution | None:
        """The range differs from its value on Init & Trans."""
        return apart_from_context(self, context, "range_m")

    @readout("mrad")
    def blur_x_mrad(self, axis: str, context: Context) -> float:
        """Signed width of the horizontal smear."""
        platform, image = f"platform_velocity_{axis}", f"image_velocity_{axis}"
        velocity = getattr(self, platform) - getattr(self, image)
        if velocity == 0 or self.integration_time_s == 0:
            return 0.0
        return blur_mrad(
            velocity_m_per_s=velocity,
            time_s=self.integration_time_s,
            range_m=given("range_m", self.range_m, context),
        )
