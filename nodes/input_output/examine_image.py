"""Examine Image: figures, histogram and pixel probe of what is on a wire."""

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, NamedTuple

import numpy as np

from core.arrays import Array
from core.chain.engine import asked_for, realize
from core.chain.wires import (
    Curve,
    CurveData,
    Image,
    Magnitude,
    Phase,
    Series,
    Table,
    TableData,
    Transfer,
    spectrum,
)
from core.errors import DataError, ParameterError
from core.evaluation.recipes import ends_lineage, in_blocks
from core.evaluation.work import Work
from core.modules.declaration import Caution, Formula, Module, NodeContext, Section, param, warning
from core.physics.detector.photon_conversion import SHORTEST_THERMAL_UM
from core.physics.radiometry.planck import brightness_temperature
from nodes.input_output.sample_unit import histogram, statistics
from nodes.shared.context_defaults import is_radiance, is_temperature
from nodes.shared.module_ports import TableFigures

Display = Literal["linear", "log", "centred_spectrum"]
Band = tuple[float, float]


class ExamineOutputs(NamedTuple):
    table: Table
    curve: Curve


class ExamineImage(
    Module, key="examine_image", title="Examine Image", group="Input and output", sink=True
):
    """Report minimum, maximum, mean, standard deviation, histogram and single samples.

    For radiance in a known band, the apparent temperature is also given: a black body at this
    temperature has the same band radiance. Read-outs and probe use the samples themselves (spectra
    in FFT order); the histogram uses the displayed values. A picture's centred spectrum is shown as
    the logarithm of its modulus.
    """

    formulas = (
        Formula(
            r"\mu=\frac{1}{N}\sum_i L_i,\quad\sigma^2=\frac{1}{N}\sum_i(L_i-\mu)^2",
            where="L_i: the N samples",
        ),
        Formula(
            r"\int_{\lambda_1}^{\lambda_2}L_\lambda(T)\,d\lambda=L",
            where="T: apparent temperature, at which a black body has the same band radiance",
            when="radiance in a known band",
        ),
    )

    renamed = MappingProxyType({"magnitude": "image", "phase": "image", "transfer": "image"})

    display: Display = param(
        "linear",
        "how the samples are shown: linear, logarithmic, or as a spectrum with zero frequency in "
        "the middle",
    )
    probe_x: int | None = param(
        None, "column of the sample to report, counted from 0", low=0, zero_is_empty=False
    )
    probe_y: int | None = param(
        None, "row of the sample to report, counted from 0", low=0, zero_is_empty=False
    )
    bins: int = param(256, "number of bins of the histogram", (1, 65536))

    panel = (
        Section("", "display"),
        Section("Pixel probe", "probe_x probe_y"),
        Section("Histogram", "bins"),
    )

    def check(self) -> None:
        if (self.probe_x is None) != (self.probe_y is None):
            name = "probe_x" if self.probe_x is None else "probe_y"
            raise ParameterError(name, None, "give both probe_x and probe_y, or neither")

    def run(self, image: Image | Magnitude | Phase | Transfer, here: NodeContext) -> ExamineOutputs:
        band, unit = None, ""
        if isinstance(image, Image):
            recipe, unit = image.recipe, image.unit
            band = image.band_um if is_radiance(unit) else None
        else:
            recipe = here.step(realized, *asked_for(image), value=image)
        x, y = self.probe_x, self.probe_y
        probe = None if x is None or y is None else (x, y)
        table = here.step(figures, recipe, unit=unit, band_um=band, probe=probe)
        how: Any = {"label": _label(image), "is_image": isinstance(image, Image)}
        curve = here.step(displayed_histogram, recipe, display=self.display, bins=self.bins, **how)
        return ExamineOutputs(Table(table), Curve(curve))

    def files(
        self, inputs: Mapping[str, Any], here: NodeContext, work: Work
    ) -> list[tuple[Path, Callable[[Path], None]]]:
        return []

    @warning
    def no_temperature(self, image: Image | Magnitude | Phase | Transfer) -> Caution | None:
        """There is no apparent temperature, because the picture is not in units of radiance."""
        if not isinstance(image, Image) or image.band_um is None:
            return None
        if is_radiance(image.unit) or is_temperature(image.unit):
            return None
        unit = f"in {image.unit!r:.40}" if image.unit.strip() else "without a unit"
        return Caution(
            f"apparent temperatures cannot be computed for a picture {unit}",
            "convert the picture to W/m²/sr: set scale and unit on Read Image, or units on Focal "
            "Plane",
        )

    figures = TableFigures(
        ("minimum", None, "Smallest sample."),
        ("maximum", None, "Largest sample."),
        ("mean", None, "Mean of the samples."),
        ("sigma", None, "Standard deviation of the samples."),
        unit_of="image",
    )


def realized(work: Work, *known: Any, value: Any) -> Array:
    """Samples of a magnitude, phase or transfer function; of a complex one the modulus."""
    samples: Array = realize(value, work)
    return np.abs(samples) if np.iscomplexobj(samples) else samples


@in_blocks()
def figures(
    work: Work, samples: Array, *, unit: str, band_um: Band | None, probe: tuple[int, int] | None
) -> TableData:
    measured = statistics(samples, for_each=work.for_each)
    values = {"minimum": measured.minimum, "maximum": measured.maximum, "mean": measured.mean}
    rows: list[tuple[Any, ...]] = [*values.items(), ("sigma", measured.sigma)]
    if probe is not None:
        sizes = zip(("probe_x", "probe_y"), probe, samples.shape[::-1], strict=True)
        for name, index, size in sizes:
            if index >= size:
                raise ParameterError(name, index, f"0 to {size - 1}")
        values["probe"] = float(samples[probe[1], probe[0]])
        where = f"sample at column {probe[0]}, row {probe[1]}"
        rows.append(("probe", values["probe"], unit, where))
    if band_um is not None and band_um[0] >= SHORTEST_THERMAL_UM:
        for name, value in values.items():
            meaning = f"apparent temperature of {name}, {band_um[0]:g} to {band_um[1]:g} µm"
            rows.append((f"{name}_K", apparent_temperature(value, band_um), "K", meaning))
    return ExamineImage.figures.table(*rows, unit=unit)


def apparent_temperature(radiance: float, band_um: Band) -> float | None:
    """Brightness temperature, K; None of noise below 0, and of a band of reflected light."""
    if band_um[0] < SHORTEST_THERMAL_UM:
        return None
    try:
        kelvin = brightness_temperature(
            radiance=radiance, cut_on_um=band_um[0], cut_off_um=band_um[1]
        )
    except DataError:
        return None
    return float(kelvin)


@in_blocks(lambda display, **_: display == "linear")
def displayed_histogram(
    work: Work, samples: Array, *, display: Display, bins: int, label: str, is_image: bool
) -> CurveData:
    logarithmic = display == "log" or (display == "centred_spectrum" and is_image)
    shown = displayed(work, samples, display=display, is_image=is_image)
    centres, counts = histogram(shown, bins=bins, check=work.check)
    named = "magnitude of the spectrum" if display == "centred_spectrum" and is_image else label
    x_label = f"log10 |{named}|" if logarithmic else named
    return CurveData("Histogram", x_label, "samples", (Series("samples", centres, counts),))


def displayed(work: Work, samples: Array, *, display: Display, is_image: bool) -> Array:
    """The samples as a viewer shows them; a logarithm of 0 becomes the least other one."""
    if display == "linear":
        return samples
    if display == "log":
        return logarithm(work, samples)
    if is_image:
        samples = logarithm(work, spectrum(work, samples))
    return np.asarray(np.fft.fftshift(samples))


@ends_lineage
def logarithm(_work: Work, samples: Array) -> Array:
    """Decimal logarithm of the modulus; 0 becomes the least other modulus."""
    modulus = np.abs(samples)
    lit = modulus > 0
    least = modulus.min(where=lit, initial=np.inf) if lit.any() else 1.0
    np.maximum(modulus, modulus.dtype.type(least), out=modulus)
    return np.asarray(np.log10(modulus, out=modulus))


def _label(value: Image | Magnitude | Phase | Transfer) -> str:
    if isinstance(value, Image):
        return f"value ({value.unit})" if value.unit else "value"
    if isinstance(value, Phase) or (isinstance(value, Transfer) and value.part == "ptf"):
        return "phase (rad)"
    return "MTF" if isinstance(value, Transfer) else "magnitude"
