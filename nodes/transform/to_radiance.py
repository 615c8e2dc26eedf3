"""To Radiance: a picture of temperatures as band radiance."""

from core.chain.wires import Image
from core.errors import DataError
from core.modules.declaration import Formula, NodeContext
from nodes.shared.context_defaults import is_radiance, is_temperature
from nodes.shared.module_ports import ImageOutput
from nodes.transform.radiometry_steps import Radiometry, radiance_of_temperature


class ToRadiance(Radiometry, key="to_radiance", title="To Radiance", group="Transform"):
    """Convert a picture of temperatures to radiance, by Planck's law in the band.

    The radiance is ε·L(T) + (1 − ε)·L(surroundings); without surroundings nothing is reflected. The
    picture's unit, set on Read Image, must be a temperature (K, °C, °F, mK): digital numbers and
    radiance are refused. An image of emissivities can replace the single value. Sources:
    Planck's and Kirchhoff's laws; Holst 2000, Common Sense Approach to Thermal Imaging.
    """

    formulas = (
        Formula(
            r"L=\varepsilon\,L_B(T)+(1-\varepsilon)\,L_B(T_s)",
            where="ε: emissivity; T: temperature of the picture, K; T_s: temperature of the "
            "surroundings",
        ),
        Formula(
            r"L_B(T)=\int_{\lambda_1}^{\lambda_2}\frac{2hc^2}{\lambda^5}\;\frac{d\lambda}{e^{"
            r"hc/(\lambda kT)}-1}",
            where="λ₁, λ₂: the band",
        ),
    )

    def run(self, image: Image, here: NodeContext, emissivity: Image | None = None) -> ImageOutput:
        if not is_temperature(image.unit):
            named = f"in {image.unit!r:.40}" if image.unit.strip() else "without a unit"
            what = "already radiance" if is_radiance(image.unit) else "not a temperature"
            raise DataError(
                f"the picture, {named}, is {what}: To Radiance needs K, °C, °F or mK; set the "
                "unit on Read Image"
            )
        surface, unit = self.surface(image), image.unit.strip()
        inputs = image.recipe, *self.shares(image, emissivity)
        made = here.step(radiance_of_temperature, *inputs, unit=unit, **surface)
        band = surface["cut_on_um"], surface["cut_off_um"]
        return ImageOutput(image.with_recipe(made, unit="W/m²/sr", band_um=band))
