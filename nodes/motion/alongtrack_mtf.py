"""Alongtrack MTF: smear by the platform's forward motion."""

from core.chain.wires import Context, Magnitude
from core.modules.declaration import Caution, Formula, NodeContext, param, readout, warning
from core.physics.sampling.platform_motion import blur_mrad, motion_mtf
from nodes.shared.context_defaults import apart_from_context, given
from nodes.shared.module_ports import MtfModule, MtfOutputs, separable


class AlongtrackMTF(MtfModule, key="alongtrack_mtf", title="Alongtrack MTF", group="Motion"):
    """Smear along the track from the platform's forward motion while a sample is collected.

    The MTF is sinc(b·eta) with b = velocity·time/range. Source: Tantalo 1996, eqs. 4.24 to 4.28.
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
        return self.mtf_outputs(
            magnitude, *separable(motion_mtf, y=y, label=self.title, node=here.node)
        )

    @warning
    def distance(self, context: Context) -> Caution | None:
        """The range differs from its value on Init & Trans."""
        return apart_from_context(self, context, "range_m")

    @warning
    def velocity(self, context: Context) -> Caution | None:
        """The velocity differs from its value on Init & Trans."""
        return apart_from_context(self, context, "velocity_m_per_s")

    @readout("mrad")
    def blur_y_mrad(self, context: Context) -> float:
        """Width of the smear along the track."""
        velocity = self.velocity_m_per_s
        if velocity is None:
            velocity = context.velocity_m_per_s
        if velocity == 0 or self.integration_time_s == 0:
            return 0.0
        return blur_mrad(
            velocity_m_per_s=velocity,
            time_s=self.integration_time_s,
            range_m=given("range_m", self.range_m, context),
        )
