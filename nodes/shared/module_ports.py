"""Outputs and factors that several modules share, and the bases of MTF and PTF modules."""

from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, Literal, NamedTuple

from core.chain.engine import PlannedNode
from core.chain.step_lineage import lineage_of
from core.chain.wires import Context, Image, Magnitude, Phase, Table, TableData, Transfer
from core.evaluation.recipes import Recipe, Step, marked
from core.evaluation.work import Work
from core.modules.declaration import Caution, Module, NodeContext, Param, readout, warning
from core.modules.preview import Picture, Preview, brief, pair
from core.physics.sampling.detector_sampling import ifov_mrad
from core.transfer.factors import Factor, Grid, Law, Part, Planar, Separable
from nodes.shared.context_defaults import pitch_in_samples

_FINER = 1.05  # samples per pixel

# MTF at both Nyquist frequencies: of the samples that are computed, and of the pixels.


def at_nyquist(transfer: Transfer, axis: str) -> Recipe | None:
    """At the Nyquist frequency of the image's samples; None of a function with its own."""
    if transfer.own is not None:
        return None
    grid = transfer.grid
    return transfer.at(axis, grid.nyquist_x if axis == "x" else grid.nyquist_y)


def at_pixel_nyquist(transfer: Transfer, context: Context, axis: str) -> Recipe | None:
    """At half a cycle per detector pitch; None where that or the focal length is not known."""
    pitch_um = context.detector_x_um if axis == "x" else context.detector_y_um
    if not pitch_um or not context.focal_length_mm or transfer.own is not None:
        return None
    nyquist = 0.5 / ifov_mrad(pitch_um=pitch_um, focal_length_mm=context.focal_length_mm, fill=1.0)
    return transfer.at(axis, nyquist)


class NyquistReadouts(Module):
    """Base of modules with an MTF, read out at the Nyquist frequencies of samples and pixels."""

    @readout()
    def mtf_at_nyquist_x(self, axis: str, outputs: Any) -> Recipe | None:
        """MTF at the horizontal Nyquist frequency of the image's samples."""
        return at_nyquist(outputs.mtf, axis)

    @readout()
    def mtf_at_pixel_nyquist_x(self, axis: str, context: Context, outputs: Any) -> Recipe | None:
        """MTF at the pixels' horizontal Nyquist frequency, half a cycle per detector pitch."""
        return at_pixel_nyquist(outputs.mtf, context, axis)


class BeforeDigits(Module):
    """Base class of modules that act on light or charge, before Focal Plane digitizes it."""

    @warning
    def digits(self, image: Image) -> Caution | None:
        """The picture is already in digital numbers."""
        if image.unit.strip() != "DN":
            return None
        return Caution(
            "this node acts on digital numbers, which include offset and noise",
            "put this node before Focal Plane",
        )


class OfPixels(BeforeDigits):
    """Base of modules that count every sample as a pixel."""

    @warning
    def samples(self, image: Image) -> Caution | None:
        """The picture has several samples per pixel."""
        samples = max(pitch_in_samples(axis, image) or 1.0 for axis in ("x", "y"))
        if samples < _FINER:
            return None
        return Caution(
            f"the picture has {samples:.3g} samples per pixel, but this node treats every sample "
            "as a pixel",
            "put this node after Sample Pixels or Combine Pixels",
        )


Apply = Annotated[
    Literal["multiply", "filter_only"],
    Param("multiply the input by the transfer function, or output the transfer function alone"),
]


class ImageOutput(NamedTuple):
    image: Image


class PictureTable(NamedTuple):
    image: Image
    table: Table


class NoiseOutputs(NamedTuple):
    image: Image
    noise: Image


class MtfOutputs(NamedTuple):
    magnitude: Magnitude
    mtf: Transfer


class PtfOutputs(NamedTuple):
    phase: Phase
    ptf: Transfer


class MtfModule(NyquistReadouts):
    """Base of modules that multiply a magnitude by an MTF."""

    apply: Apply = "multiply"

    def mtf_outputs(self, magnitude: Magnitude, *factors: Factor) -> MtfOutputs:
        """Outputs for these factors; none of them is the identity, whose key passes through."""
        transfer = magnitude.transfer("mtf", factors, self.title)
        made = magnitude.only if self.apply == "filter_only" else magnitude.times
        return MtfOutputs(made(*factors), transfer)

    def separated(
        self, magnitude: Magnitude, here: NodeContext, function: Callable[..., Any], **how: Any
    ) -> MtfOutputs:
        """Outputs for a factor of a function on either axis, as `separable` makes it."""
        factors = separable(function, label=self.title, node=here.node, **how)
        return self.mtf_outputs(magnitude, *factors)


class PtfModule(Module):
    """Base class of modules that add a PTF to a phase."""

    apply: Apply = "multiply"

    def ptf_outputs(self, phase: Phase, *factors: Factor) -> PtfOutputs:
        """Outputs for these factors; none of them is the identity, whose key passes through."""
        transfer = phase.transfer("ptf", factors, self.title)
        made = phase.only if self.apply == "filter_only" else phase.plus
        return PtfOutputs(made(*factors), transfer)

    @readout("rad")
    def ptf_at_nyquist_x(self, outputs: PtfOutputs) -> Recipe | None:
        """PTF at the horizontal Nyquist frequency of the image's samples."""
        return at_nyquist(outputs.ptf, "x")

    @readout("rad")
    def ptf_at_pixel_nyquist_x(self, context: Context, outputs: PtfOutputs) -> Recipe | None:
        """PTF at the pixels' horizontal Nyquist frequency, half a cycle per detector pitch."""
        return at_pixel_nyquist(outputs.ptf, context, "x")


CutOn = Annotated[float | None, Param("shortest wavelength; empty: from the image's band", low=0)]
CutOff = Annotated[float | None, Param("longest wavelength; empty: from the image's band", low=0)]
NewWidth = Annotated[
    int | None, Param("samples per row; empty: unchanged", low=1, high=65536, slider=(16, 2048))
]
NewHeight = Annotated[
    int | None, Param("samples per column; empty: unchanged", low=1, high=65536, slider=(16, 2048))
]
LongestPeriod = Annotated[
    float,
    Param("longest period of the 1/f noise: time since the last correction", low=1e-9, high=1e9,
          slider=(1, 3600)),
]  # fmt: skip
WeightingSource = Annotated[
    float | None,
    Param("temperature of the black body that weights a single band; empty: 5800 K if the band "
          "begins below 2.5 µm, else the brightness temperature of the picture's mean",
          low=0, high=1e6, slider=(250, 6500)),
]  # fmt: skip
LightingSource = Annotated[
    float | None,
    Param("temperature of the black body that weights the band; empty: 5800 K if the band "
          "begins below 2.5 µm, else the brightness temperature of the picture's mean",
          low=0, high=1e6, slider=(200, 6500)),
]  # fmt: skip


def figure_reason(work: Work, table: TableData, *, name: str) -> str:
    return next((row.reason for row in table.rows if row.name == name), "")


@marked(reason=figure_reason)
def figure(work: Work, table: TableData, *, name: str) -> float | int | str | None:
    return table.as_dict().get(name)


class TableFigures:
    """Read-outs that are figures of the module's table: name, unit and meaning of each.

    A fourth entry is the name of the row, where it is another; `unit_of` the input whose unit those
    have whose own is None; `table` gives the table of the outputs.
    """

    def __init__(
        self,
        *figures: tuple[Any, ...],
        unit_of: str = "",
        table: Callable[[Any], Recipe] = lambda outputs: outputs.table.recipe,
    ) -> None:
        self._figures, self._unit_of, self._table = figures, unit_of, table

    def __set_name__(self, owner: type[Module], _: str) -> None:
        for name, unit, meaning, *row in self._figures:
            method = self._method(*row or (name,))
            method.__doc__ = meaning
            unit_of = self._unit_of if unit is None else ""
            marked = readout(unit or "", name=name, unit_of=unit_of)(method)
            setattr(owner, f"{name}_figure", marked)

    def _method(self, row: str) -> Callable[..., Step]:
        def method(_: Module, outputs: Any) -> Step:
            return Step.of(figure, self._table(outputs), name=row)

        return method

    def table(self, *rows: tuple[Any, ...], unit: str = "") -> TableData:
        """Rows of figures, (name, value[, reason]), and (name, value, unit, meaning[, reason]).

        Figures have the unit and meaning declared here; `unit` is that of the input `unit_of`. A
        meaning loses its full stop, and its capital unless it begins an abbreviation.
        """
        declared = {name: texts for name, *texts in self._figures}

        def row(name: str, value: Any, *rest: str) -> tuple[Any, ...]:
            if len(rest) > 1:
                return name, value, *rest
            own, text = declared[name][:2]
            start = text[0].lower() if text[1].islower() else text[0]
            text = start + text[1:].removesuffix(".")
            return name, value, unit if own is None else own, text, *rest

        return TableData.of(*(row(*each) for each in rows))


def separable(
    function: Callable[..., Any],
    *,
    x: Mapping[str, Any] | None = None,
    y: Mapping[str, Any] | None = None,
    part: Part = "mtf",
    argument: str = "frequency",
    scale_x: float = 1.0,
    scale_y: float = 1.0,
    label: str = "",
    node: str | None = None,
) -> tuple[Separable, ...]:
    """A separable factor; None for an axis is the identity there, for both it gives no factor."""
    if x is None and y is None:
        return ()
    laws = [
        None if parameters is None else Law.of(function, scale=scale, **parameters)
        for parameters, scale in ((x, scale_x), (y, scale_y))
    ]
    return (Separable(laws[0], laws[1], part, argument, label=label, node=node),)


def radial(
    function: Callable[..., Any], *, label: str = "", node: str | None = None, **parameters: Any
) -> tuple[Planar, ...]:
    return (Planar(Law.of(function, **parameters), radial=True, label=label, node=node),)


def passed_factors(image: Image) -> list[Factor]:
    """The factors on the way to a picture, those of the last step first."""
    here = Grid(*image.shape, image.interval_x_mrad or 1.0, image.interval_y_mrad or 1.0)
    recipe = image.recipe
    factors: list[Factor] = []
    while (lineage := lineage_of(recipe)) is not None and lineage.picture is not None:
        before = lineage.linear.grid_before(here)
        factors += lineage.linear.transfer(before, here, recipe.node)
        recipe, here = lineage.picture, before
    return factors


def transfers(factors: Sequence[Factor], image: Image, label: str) -> tuple[Transfer, Transfer]:
    """MTF and PTF of what filters a picture itself, to look at."""
    mtf, ptf = (
        Transfer(
            image.grid(),
            part,
            tuple(factor for factor in factors if factor.part == part),
            label=label,
            pixel_mrad=image.pixel_mrad,
        )
        for part in ("mtf", "ptf")
    )
    return mtf, ptf


class OtfOutputs(NamedTuple):
    magnitude: Magnitude
    phase: Phase
    mtf: Transfer
    ptf: Transfer


def otf_outputs(
    apply: Apply,
    magnitude: Magnitude,
    phase: Phase | None,
    *,
    blur: Sequence[Factor],
    shift: Sequence[Factor] = (),
    label: str,
) -> OtfOutputs:
    """The spectrum times the OTF, or the OTF alone; a phase that is not linked begins here."""
    if phase is None:
        phase = Phase(None, magnitude.grid, magnitude.edges)
    mtf = magnitude.transfer("mtf", tuple(blur), label)
    ptf = magnitude.transfer("ptf", tuple(shift), label)
    if apply == "filter_only":
        return OtfOutputs(magnitude.only(*blur), phase.only(*shift), mtf, ptf)
    return OtfOutputs(magnitude.times(*blur), phase.plus(*shift), mtf, ptf)


class PicturePreview(Module):
    """A module whose output `image` is shown at the top of its panel."""

    preview_lines = 10.0

    def preview(self, planned: PlannedNode, work: Work, _here: NodeContext) -> Preview:
        image: Image = planned.sound().outputs["image"]
        samples = work.value(image.recipe)
        x, y = image.interval_x_mrad, image.interval_y_mrad
        low, high = float(samples.min()), float(samples.max())
        facts = [
            f"{image.columns} × {image.rows} samples",
            f"{brief(low)} to {brief(high)} {image.unit}".rstrip(),
            "no field of view" if x is None or y is None else f"interval {pair(x, y)} mrad",
        ]
        if image.band_um is not None:
            facts.append(f"{brief(image.band_um[0])} to {brief(image.band_um[1])} µm")
        picture = Picture(samples, low, high, _shape(image))
        return Preview(", ".join(facts), (picture,), tuple(facts))


def _shape(image: Image) -> tuple[float, float]:
    """Width and height as they are seen: in mrad where both intervals are known."""
    x, y = image.interval_x_mrad, image.interval_y_mrad
    if x is None or y is None or not 0.1 < (x * image.columns) / (y * image.rows) < 10:
        return float(image.columns), float(image.rows)
    return x * image.columns, y * image.rows
