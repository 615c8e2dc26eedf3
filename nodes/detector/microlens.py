"""Microlens Angle: pixels respond less to light that meets their microlenses at an angle."""

from pathlib import Path
from typing import Any, Literal

from core.chain.wires import Image
from core.errors import ParameterError
from core.modules.declaration import Formula, NodeContext, Section, param
from core.physics.optics.field import MOST_DEG, microlens_response
from nodes.optics.vignetting import Law, LightOverField, corner, curve, darkened
from nodes.shared.module_ports import ImageOutput


class MicrolensAngle(LightOverField, key="microlens", title="Microlens Angle", group="Detector"):
    """Darken the picture where the chief ray angle differs from the microlenses' design angle.

    The detector's data sheet gives the chief ray angle (CRA) for which the microlenses at the
    corner are designed. The lens's data sheet gives the CRA of the lens. If the CRAs of lens and
    microlenses are equal, the picture does not change. A difference lowers the response: to half at
    `half_response_deg` or, if `response` is file, according to a measured curve. The optical axis
    is at the middle of the picture, and the corner angles apply at the picture's corners. Only the
    chief ray counts: the response is not averaged over the cone of a fast lens. Put this module
    before Focal Plane, which then computes the shot noise of the darkened picture. Signal and SNR
    use the mean response over the field; transfer functions do not change. Source: Catrysse and
    Wandell 2002, J. Opt. Soc. Am. A 19, 1610.
    """

    formulas = (
        Formula(
            r"L'=L\,R(\delta),\quad\delta=\left|\arctan(h\tan\alpha)-\arctan(h\tan\alpha_m)\right|",
            where="h: distance from the middle, 1 at the corner; α: chief_ray_deg; α_m: "
            "matched_deg; R = 2^(−(δ/δ_half)²), or the curve in the file",
        ),
    )

    chief_ray_deg: float = param(
        0.0,
        "chief ray angle of the lens at the corner",
        (-MOST_DEG, MOST_DEG),
        unit="deg",
        slider=(-40, 40),
    )
    matched_deg: float = param(
        0.0,
        "chief ray angle that the microlenses at the corner are designed for",
        (-MOST_DEG, MOST_DEG),
        unit="deg",
        slider=(-40, 40),
    )
    response: Literal["half_angle", "file"] = param(
        "half_angle",
        "response versus angle: computed from half_response_deg, or a measured curve from a file",
    )
    half_response_deg: float = param(
        20.0,
        "angle difference at which the response falls to half",
        (0.1, 90),
        unit="deg",
        slider=(5, 45),
    )
    path: Path | None = param(
        None, "CSV file of angle difference (°) and response, which is 1 at 0°"
    )

    panel = (
        Section("Chief ray at the corner", "chief_ray_deg matched_deg"),
        Section("Response", "response"),
        Section("", "half_response_deg", shown_when=("response", ("half_angle",))),
        Section("", "path", shown_when=("response", ("file",))),
    )

    def check(self) -> None:
        if self.response == "file" and self.path is None:
            raise ParameterError("path", None, "give a CSV file of angle difference and response")

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        if self.off:
            return ImageOutput(image)
        return ImageOutput(darkened(image, self._law(image, here), here))

    def _law(self, image: Image, here: NodeContext) -> Law:
        law: dict[str, Any] = {
            "function": microlens_response,
            "corner": corner(image.grid()),
            "chief_ray_deg": self.chief_ray_deg,
            "matched_deg": self.matched_deg,
        }
        if self.response == "half_angle":
            return (*law.items(), ("half_response_deg", self.half_response_deg))
        assert self.path is not None
        file = (here.folder / self.path).absolute()
        return (*law.items(), *curve(file, "angles", "deg", "response"))

    @property
    def off(self) -> bool:
        return self.chief_ray_deg == self.matched_deg
