"""What To Radiance and To Temperature share: emissivity, surroundings, band."""

from __future__ import annotations

from typing import Annotated

from core.chain.wires import Image
from core.errors import DataError, ParameterError
from core.evaluation.recipes import Recipe
from core.modules.caution import Caution
from core.modules.declaration import Module, warning
from core.modules.panel_sections import Section
from core.modules.parameters import Param
from nodes.shared.common_parameters import CutOff, CutOn
from nodes.shared.shared_warnings import band_caution
from nodes.transform.radiometry_steps import Surface


class Radiometry(Module):
    """Surfaces of one emissivity in a band."""

    emissivity: Annotated[
        float, Param("emissivity of all samples, where no image of it comes in", low=0, high=1,
                     above=True)
    ] = 1.0  # fmt: skip
    surroundings_K: Annotated[
        float | None,
        Param("temperature of what surfaces reflect; empty: nothing", unit="K", low=0, high=1e4,
              slider=(200, 320)),
    ] = None  # fmt: skip
    cut_on_um: CutOn = None
    cut_off_um: CutOff = None

    panel = (
        Section("Surfaces", ("emissivity", "surroundings_K")),
        Section("Band", ("cut_on_um", "cut_off_um")),
    )

    def surface(self, image: Image) -> Surface:
        """The surfaces in the band here, else the image's.

        Raises
        ------
        ParameterError
            If no band is known, or it is empty.
        """
        of_image = image.band_um or (None, None)
        low = of_image[0] if self.cut_on_um is None else self.cut_on_um
        high = of_image[1] if self.cut_off_um is None else self.cut_off_um
        for name, value in (("cut_on_um", low), ("cut_off_um", high)):
            if value is None:
                raise ParameterError(
                    name, None, "the image does not say its band: give it here", unit="µm"
                )
        assert low is not None
        assert high is not None
        if not low < high:
            raise ParameterError("cut_off_um", high, f"above cut_on_um = {low:g}", unit="µm")
        return Surface(self.emissivity, self.surroundings_K, low, high)

    def shares(self, image: Image, emissivity: Image | None) -> tuple[Recipe, ...]:
        """The image of emissivities, where one comes in.

        Raises
        ------
        DataError
            If it is of another size.
        """
        if emissivity is None:
            return ()
        if emissivity.shape != image.shape:
            raise DataError(
                f"the emissivity is {emissivity.columns} × {emissivity.rows} samples and the "
                f"picture {image.columns} × {image.rows}: they have to be of one size"
            )
        return (emissivity.recipe,)

    @warning
    def band(self, image: Image) -> Caution | None:
        """A band that is not the picture's."""
        return band_caution(image.band_um, self.cut_on_um, self.cut_off_um)
