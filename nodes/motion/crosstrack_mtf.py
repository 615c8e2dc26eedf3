"""Crosstrack MTF: smear by the scan within one dwell time."""

from core.chain.wires import Context, Magnitude
from core.modules.declaration import Caution, Formula, NodeContext, param, readout, warning
from core.physics.sampling.platform_motion import motion_mtf, scan_blur_mrad
from nodes.shared.context_defaults import apart_from_context
from nodes.shared.module_ports import MtfModule, MtfOutputs


class CrosstrackMTF(MtfModule, key="crosstrack_mtf", title="Crosstrack MTF", group="Motion"):
    """Smear across the track from the scan during one dwell time.

    The MTF is sinc(v·t·xi). A dwell time of 0 gives no smear. Source: Tantalo 1996, section 4.4.1;
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
        return self.separated(magnitude, here, motion_mtf, x=x)

    @warning
    def velocity(self, context: Context) -> Caution | None:
        """The scan velocity differs from its value on Init & Trans."""
        return apart_from_context(self, context, "scan_velocity_mrad_per_s")

    @readout("mrad")
    def blur_mrad(self, context: Context) -> float:
        """Width of the smear across the track."""
        velocity = self.scan_velocity_mrad_per_s
        if velocity is None:
            velocity = context.scan_velocity_mrad_per_s
        return scan_blur_mrad(scan_velocity_mrad_per_s=velocity, dwell_time_s=self.dwell_time_s)
