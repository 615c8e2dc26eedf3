"""To Temperature: a picture of band radiance as temperatures."""

from core.chain.wires import Image
from core.modules.declaration import Formula, NodeContext
from nodes.shared.context_defaults import watts_factor
from nodes.shared.module_ports import ImageOutput
from nodes.transform.radiometry_steps import Radiometry, temperature_of_radiance


class ToTemperature(Radiometry, key="to_temperature", title="To Temperature", group="Transform"):
    """Convert a picture of band radiance to temperatures in kelvin.

    This is the inverse of To Radiance: T is the temperature at which Planck's law gives the
    radiance (L − (1 − ε)·L(surroundings))/ε in the band. With an emissivity of 1, the result is the
    apparent, or brightness, temperature. The picture's unit must be band radiance in watts
    (W/m²/sr, mW/cm²/sr, …): temperatures, digital numbers, photons and spectral radiance are
    refused. An image of emissivities can replace the single value. Sources: as for To Radiance.
    """

    formulas = (
        Formula(
            r"T=L_B^{-1}\left(\frac{L-(1-\varepsilon)\,L_B(T_s)}{\varepsilon}\right)",
            where="L: radiance of the picture, W/m²/sr; ε: emissivity; T_s: temperature of the "
            "surroundings; L_B: Planck's law in the band",
        ),
    )

    def run(self, image: Image, here: NodeContext, emissivity: Image | None = None) -> ImageOutput:
        surface = self.surface(image)
        factor = watts_factor(
            image.unit,
            temperature="already a temperature",
            needed="To Temperature needs radiance in W/m²/sr; set the unit on Read Image",
        )
        inputs = image.recipe, *self.shares(image, emissivity)
        made = here.step(temperature_of_radiance, *inputs, factor=factor, **surface)
        band = surface["cut_on_um"], surface["cut_off_um"]
        return ImageOutput(image.with_recipe(made, unit="K", band_um=band))
