"""The spectral bands of a test scene: their sums are drawn, never a cube."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError
from core.evaluation.recipes import Recipe, Step, ends_lineage
from core.evaluation.work import Work
from core.lineage.step_lineage import source_step
from core.spectrum.band_stack import BandStack, Row, Rows, stacked
from nodes.files.common.size_limits import oversized
from nodes.scenes import draw_shares
from nodes.scenes.draw import draw_radiances
from nodes.scenes.scene_in_bands import (
    Spectra,
    band_edges,
    drawn_means,
    scene_spectra,
    shown_means,
    weighted,
)
from nodes.scenes.two_steps import Shares, show_radiances

Parameters = tuple[tuple[str, Any], ...]


@dataclass(frozen=True)
class SceneBands(BandStack):
    """Bands of a test scene.

    Parameters
    ----------
    spectra : Recipe
        Those of its surfaces and textures.
    shares : Recipe or None
        Where they are seen; None where the scene is drawn anew for each sum.
    drawing : tuple of (name, value)
        Kind, size and geometry, as `nodes.scenes.draw.draw_radiances` takes them, of a scene that
        is drawn anew.
    node : str, optional
        Node an error belongs to.
    """

    spectra: Recipe
    shares: Recipe | None
    drawing: Parameters
    node: str | None = field(default=None, compare=False)

    @classmethod
    def of(
        cls,
        *,
        shares: Recipe | None,
        drawing: dict[str, Any],
        bands: int,
        sources: dict[str, Any],
        node: str,
    ) -> SceneBands:
        """Bands of equal width; `sources` as `nodes.scenes.scene_in_bands.scene_spectra` takes."""
        ends = {name: sources[name] for name in ("cut_on_um", "cut_off_um")}
        edges = band_edges(**ends, bands=bands)
        centres, widths = (edges[1:] + edges[:-1]) / 2.0, np.diff(edges)
        spectra = Step.of(spectra_made, node=node, kind=drawing["kind"], bands=bands, **sources)
        return cls(
            tuple(map(float, centres)),
            tuple(map(float, widths)),
            spectra,
            shares,
            tuple(sorted(drawing.items())) if shares is None else (),
            node,
        )

    def _content(self) -> tuple[object, ...]:
        shares = None if self.shares is None else self.shares.key
        return self.spectra.key, shares, self.drawing

    def picture(self, weights: Row) -> Recipe:
        """The scene of the surfaces' weighted sums."""
        weights = tuple(map(float, weights))
        if self.shares is not None:
            return Step.of(sum_shown, self.shares, self.spectra, node=self.node, weights=weights)
        return Step.of(
            sum_drawn, self.spectra, node=self.node, weights=weights, **dict(self.drawing)
        )

    def sums(self, weights: Rows) -> Recipe:
        """Several of them."""
        return stacked(tuple(self.picture(row) for row in weights))

    def means(self) -> Recipe:
        """Means of the bands, by the mean share of each surface."""
        if self.shares is not None:
            return Step.of(means_shown, self.shares, self.spectra, node=self.node)
        return Step.of(means_drawn, self.spectra, node=self.node, **dict(self.drawing))


def refuse_oversized(work: Work, *, width: int, height: int, **_others: Any) -> None:
    """Refuse a scene that the machine has no room for, as a picture file of its size is."""
    if work.blocks is not None and work.blocks.disk.wants((height, width), work.policy.dtype):
        return
    if reason := oversized(height, width, np.dtype(work.policy.dtype)):
        raise DataError(f"height × width: {reason}")


@ends_lineage
def shares_drawn(work: Work, **values: Any) -> Shares:
    """Where the scene's surfaces are seen."""
    refuse_oversized(work, **values)
    return draw_shares(dtype=work.policy.dtype, for_each=work.for_each, **values)


@ends_lineage
def spectra_made(_: Work, **values: Any) -> Spectra:
    """Spectra of all that the scene is made of."""
    return scene_spectra(**values)


@source_step(area_means=True)
def sum_shown(
    work: Work, shares: Shares, spectra: Spectra, *, weights: Row
) -> NDArray[np.floating]:
    """A weighted sum of the bands from the shares of the scene's surfaces."""
    return show_radiances(shares, weighted(spectra, weights), work.for_each)


@source_step(area_means=True)
def sum_drawn(
    work: Work, spectra: Spectra, *, weights: Row, **drawing: Any
) -> NDArray[np.floating]:
    """A weighted sum of the bands, drawn at once."""
    refuse_oversized(work, **drawing)
    return draw_radiances(
        weighted(spectra, weights), dtype=work.policy.dtype, for_each=work.for_each, **drawing
    )


@ends_lineage
def means_shown(_: Work, shares: Shares, spectra: Spectra) -> NDArray[np.float64]:
    """Mean of every band."""
    return shown_means(shares, spectra)


@ends_lineage
def means_drawn(work: Work, spectra: Spectra, **drawing: Any) -> NDArray[np.float64]:
    """Mean of every band of a scene that is drawn at once."""
    refuse_oversized(work, **drawing)
    return drawn_means(spectra, dtype=np.float64, for_each=work.for_each, **drawing)
