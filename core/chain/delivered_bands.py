"""The bands of a filtered image: each sum of them is filtered as one picture."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from core.evaluation.recipes import Recipe
from core.spectrum.band_stack import BandStack, Row, Rows, stacked

Filtered = Any
"""A `core.chain.back_transformed.Delivered`, whose file imports this one."""


@dataclass(frozen=True)
class DeliveredBands(BandStack):
    """Bands behind a back transform.

    Parameters
    ----------
    before : BandStack
        Those of the image before it.
    delivered : Delivered
        The filtered image, of which a sum of bands has the weights.
    """

    before: BandStack
    delivered: Filtered

    @classmethod
    def of(cls, before: BandStack, delivered: Filtered) -> DeliveredBands:
        """Bands at the wavelengths of those before."""
        plain = replace(delivered, weights=None)
        return cls(before.centres_um, before.widths_um, before, plain, density=before.density)

    @property
    def in_blocks(self) -> bool:
        """Where both the filter and the bands before are."""
        return self.before.in_blocks and self.picture(self.whole).in_blocks

    def _content(self) -> tuple[object, ...]:
        return self.before.key, self.delivered.key

    def picture(self, weights: Row) -> Recipe:
        """The filtered sum."""
        filtered: Recipe = replace(self.delivered, weights=weights)
        return filtered

    def sums(self, weights: Rows) -> Recipe:
        """Several of them."""
        return stacked(tuple(self.picture(row) for row in weights))

    def means(self) -> Recipe:
        """Means of the bands before: no transfer function changes them."""
        return self.before.means()
