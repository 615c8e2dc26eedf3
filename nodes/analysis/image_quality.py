"""Image Quality: the interpretability of a picture by the image quality equations."""

import math
from typing import Any, Literal, NamedTuple

import numpy as np

from core.arrays import Vector
from core.chain.step_lineage import LevelChange
from core.chain.wires import Context, Curve, CurveData, Image, Series, Table, TableData
from core.errors import DataError
from core.evaluation.recipes import Recipe, Step
from core.evaluation.work import Work
from core.modules.declaration import Caution, Formula, Module, NodeContext, Section, param, warning
from core.physics.acquisition import giqe
from core.physics.detector.photon_conversion import SHORTEST_THERMAL_UM
from core.transfer.factors import Grid
from nodes.analysis import lineage
from nodes.analysis.threshold_curves import Unseen, unseen
from nodes.shared.context_defaults import apart_caution, apart_from_context, given, with_interval
from nodes.shared.module_ports import TableFigures
from nodes.shared.steps import number


class QualityOutputs(NamedTuple):
    edge: Curve
    table: Table


class ImageQuality(Module, key="image_quality", title="Image Quality", group="Analysis"):
    """Estimate the interpretability (NIIRS) of a picture with GIQE 3, 4 and 5.

    In the plane normal to the line of sight, the ground sample distance (GSD) is the picture's
    sampling interval times the range. GIQE 3 uses the GSD normal to the line of sight. GIQE 4 uses
    the GSD on the ground: GSD/√sin e, where e is the elevation of the line of sight seen from the
    target. GIQE 5 uses the geometric mean of the GSDs of GIQE 3 and 4, GSD/(sin e)^¼. The relative
    edge response (RER) is the rise of the edge response from half a sample before the edge to half
    a sample after it. The overshoot H is the maximum of the edge response 1 to 3 samples beyond the
    edge; if the response only rises there, H is the response at 1.25 samples. RER and H follow from
    the chain's transfer functions; the SNR follows from the chain's signal and temporal noise. No
    noise is simulated or measured. GSD, RER and H are geometric means of the horizontal and
    vertical values; in GIQE 5 the worse RER counts twice. Connect the picture as the sensor samples
    it, before a frame grabber interpolates it.

    With `snr_of` = `contrast`, the SNR is the difference in signal between surfaces of 15 % and 7 %
    reflectance, divided by the noise. If the scene is in reflectance and Reflected Light converts
    it to radiance, the difference follows from the illumination and the atmosphere set in that
    module. If the scene is not in reflectance, the mean radiance is assumed to come from a surface
    of 15 % reflectance, and a warning is shown. The SNR is then 8/15 of the mean signal divided by
    the noise. With `mean`, the SNR is the mean signal divided by the noise.

    GIQE 3: 11.81 + 3.32·lg(RER/GSD) − 1.48·H − G/SNR. GIQE 4: 10.251 − a·lg GSD + b·lg RER −
    0.656·H − 0.344·G/SNR (a = 3.32, b = 1.559; below an RER of 0.9, a = 3.16, b = 2.817). GIQE 5:
    9.57 − 3.32·lg GSD + 3.32·(1 − e^(−1.9/SNR))·lg RER − 2·lg⁴ RER − 1.8/SNR. GSD in inches. GIQE 3
    and 4 apply to sharpened pictures, with the noise gain G of the sharpening. GIQE 4 was fitted to
    visible pictures with GSD 3 to 80 inches, RER 0.2 to 1.3, H 0.9 to 1.9 and SNR 2 to 130. A
    warning lists values outside the limits of GIQE 4. The limits of GIQE 3 and 5 could not be
    verified.

    Sources: Leachtenauer et al. 1997, Appl. Opt. 36, 8322 (GIQE 3 and 4, SNR); Harrington et al.
    2015, GIQE version 5.0, NGA, 16 September 2015 (eqs. 2, 5 and 7).
    """

    formulas = (
        Formula(
            r"\mathrm{NIIRS}=11.81+3.32\,\lg\frac{\mathrm{RER}}{\mathrm{GSD}}-1.48\,H-\frac{G}{"
            r"\mathrm{SNR}}",
            where="GSD: inches; RER: relative edge response; H: overshoot; G: noise gain of the "
            "sharpening",
            when="GIQE 3",
        ),
        Formula(
            r"\mathrm{NIIRS}=10.251-a\,\lg\mathrm{GSD}+b\,\lg\mathrm{RER}-0.656\,H-\frac{0.344"
            r"\,G}{\mathrm{SNR}}",
            where="a = 3.32, b = 1.559; below an RER of 0.9, a = 3.16, b = 2.817",
            when="GIQE 4",
        ),
        Formula(
            r"\mathrm{NIIRS}=9.57-3.32\,\lg\mathrm{GSD}+3.32\left(1-e^{-1.9/\mathrm{SNR}}"
            r"\right)\lg\mathrm{RER}-2\,\lg^4\mathrm{RER}-\frac{1.8}{\mathrm{SNR}}",
            when="GIQE 5",
        ),
        Formula(
            r"\mathrm{GSD}_4=\frac{\mathrm{GSD}}{\sqrt{\sin e}},\quad\mathrm{GSD}_5=\frac{"
            r"\mathrm{GSD}}{\sqrt[4]{\sin e}},\quad\mathrm{RER}_5=\sqrt[3]{\mathrm{RER}_{better}"
            r"\,\mathrm{RER}_{worse}^2}",
            where="GSD: ground sample distance normal to the line of sight; e: elevation of the "
            "line of sight, seen from the target",
        ),
        Formula(
            r"E(d)=\frac{1}{2}+\frac{1}{\pi}\int_0^\infty\frac{H(\xi)\,\sin(2\pi\xi d)}{\xi}\,d"
            r"\xi",
            where="E: edge response at d samples from the edge; H: transfer function; "
            "RER = E(½) − E(−½)",
        ),
    )

    range_m: float | None = param(
        None, "slant range to the ground; empty: from Init & Trans", low=0
    )
    gsd_m: float | None = param(
        None,
        "ground sample distance normal to the line of sight, if you know it; empty: "
        "interval × range, the sampling interval times the slant range",
        low=0,
        slider=(0.1, 10),
    )
    elevation_deg: float | None = param(
        None,
        "elevation of the line of sight at the target; empty: 90° − off nadir, or "
        "from Camera's orbit if off_nadir_deg is 0",
        (0, 90),
        slider=(5, 90),
    )
    off_nadir_deg: float = param(
        0.0,
        "off-nadir look angle along the track, over flat ground; used if elevation_deg is empty",
        (0, 89),
        slider=(0, 60),
    )
    snr: float | None = param(None, "SNR, if you know it; empty: signal / temporal noise", low=0)
    snr_of: Literal["contrast", "mean"] = param(
        "contrast", "signal for the SNR: the contrast between 15 % and 7 % reflectance, or the mean"
    )
    rer_x: float | None = param(
        None, "horizontal RER, if you know it; empty: from the chain", low=0, slider=(0.1, 1.2)
    )
    rer_y: float | None = param(
        None, "vertical RER, if you know it; empty: from the chain", low=0, slider=(0.1, 1.2)
    )
    overshoot: float | None = param(
        None, "overshoot H, if you know it; empty: from the chain", low=0, slider=(0.8, 2)
    )
    noise_gain: float = param(
        1.0, "noise gain G of the sharpening; 1: no sharpening", (0, 1e6), slider=(0, 20)
    )

    panel = (
        Section("View", "range_m gsd_m elevation_deg off_nadir_deg"),
        Section("Edge", "rer_x rer_y"),
        Section("Noise", "snr snr_of"),
        Section("Sharpening", "overshoot noise_gain"),
    )

    def run(self, context: Context, image: Image, here: NodeContext) -> QualityOutputs:
        image = with_interval(image, context)
        passed, grid, node = lineage.transfer_of(image), image.grid(), here.node
        edge = here.step(edge_quality, stages=passed.part("mtf"), grid=grid)
        if self.snr is not None:
            snr: Recipe = here.step(number, value=self.snr)
        else:
            snr = here.step(
                signal_over_noise,
                lineage.NoiseOf(image, node, uniform=True),
                *passed.levels,
                gain=passed.gain,
                gain_before=passed.gain_before,
                snr_of=self.snr_of,
                reflectance=passed.reflectance,
            )
        table = here.step(quality_table, edge, snr, **self._view(context, grid))
        return QualityOutputs(Curve(here.step(edge_curve, edge)), Table(table))

    def _view(self, context: Context, grid: Grid) -> dict[str, Any]:
        elevation = self.elevation_deg
        if elevation is None and not self.off_nadir_deg:
            elevation = context.elevation_deg
        if elevation is None:
            elevation = 90.0 - self.off_nadir_deg
        if self.gsd_m is not None:
            across = along = self.gsd_m
        else:
            km = given("range_m", self.range_m, context) / 1000.0
            across, along = grid.interval_x_mrad * km, grid.interval_y_mrad * km
        what = "mean signal"
        if self.snr_of == "contrast":
            what = "contrast between 15 % and 7 % reflectance"
        words = "as entered" if self.snr is not None else f"{what} divided by temporal noise"
        return {
            "across_m": across,
            "along_m": along,
            "elevation_deg": elevation,
            "typed_rer": (self.rer_x, self.rer_y),
            "overshoot": self.overshoot,
            "noise_gain": self.noise_gain,
            "snr_words": words,
        }

    @warning
    def contrast(self, image: Image) -> Caution | None:
        """The SNR is an estimate, because the scene's reflectance is not known."""
        if self.snr is not None or self.snr_of == "mean":
            return None
        if lineage.transfer_of(image).reflectance is not None:
            return None
        return Caution(
            "the SNR is an estimate: the scene is not in reflectance, so a mean reflectance of "
            "15 % is assumed, and 8/15 of the mean signal as the contrast",
            "use Reflected Light, enter snr, or set snr_of to mean",
        )

    @warning
    def view(self, context: Context) -> Caution | None:
        """A look angle or range is not used, or differs from Camera's orbit."""
        if self.elevation_deg is not None and self.off_nadir_deg:
            return Caution(
                f"off_nadir_deg = {self.off_nadir_deg:g}° is not used: elevation_deg = "
                f"{self.elevation_deg:g}° is given",
                "leave elevation_deg empty, or set off_nadir_deg to 0",
            )
        if self.gsd_m is not None and self.range_m is not None:
            return Caution(
                f"range_m = {self.range_m:g} m is not used: gsd_m = {self.gsd_m:g} m is given",
                "leave range_m or gsd_m empty",
            )
        if context.elevation_deg is None:
            return None
        own = self.elevation_deg or (90.0 - self.off_nadir_deg if self.off_nadir_deg else None)
        remedy = (
            "to use the elevation from Camera's orbit, leave elevation_deg empty and "
            "off_nadir_deg at 0"
        )
        return apart_from_context(self, context, "range_m") or apart_caution(
            "elevation_deg", own, context.elevation_deg, where="from Camera's orbit",
            remedy=remedy,
        )  # fmt: skip

    @warning
    def band(self, image: Image, context: Context) -> Caution | None:
        """The picture is thermal, but the equations are for visible pictures."""
        band = image.band_um or context.band_um
        if band is None or band[0] < SHORTEST_THERMAL_UM:
            return None
        return Caution(
            f"NIIRS may not apply: the picture's band, {band[0]:g} to {band[1]:g} µm, is thermal, "
            "but these equations were fitted to visible pictures",
            "use Figures of Merit, or use NIIRS only to compare similar cameras",
        )

    @warning
    def limits(self, outputs: QualityOutputs) -> Recipe:
        """A value lies outside the limits of GIQE 4."""
        return Step.of(limits_caution, outputs.table.recipe)

    figures = TableFigures(
        ("giqe5", "NIIRS", "Interpretability by GIQE 5."),
        ("giqe4", "NIIRS", "Interpretability by GIQE 4."),
        ("giqe3", "NIIRS", "Interpretability by GIQE 3."),
        (
            "gsd_m",
            "m",
            "Ground sample distance normal to the line of sight, geometric mean of both axes.",
        ),
        ("gsd_ground_m", "m", "Ground sample distance on the ground, geometric mean of both axes."),
        ("rer", "", "Relative edge response, geometric mean of both axes."),
        ("overshoot", "", "Edge overshoot, geometric mean of both axes."),
        ("snr", "", "Signal divided by temporal noise; left out if there is no noise."),
    )


BRIGHT, DARK = 0.15, 0.07
"""Reflectances whose contrast is the signal of the equations (Leachtenauer et al. 1997)."""
_DRAWN = np.linspace(-4.0, 4.0, 129)  # samples beside the edge

Pair = tuple[float, float]  # horizontal and vertical


def edge_quality(
    work: Work, *, stages: lineage.Stages, grid: Grid
) -> tuple[Pair, Pair, tuple[Vector, Vector]]:
    results = []
    for line, sample_mrad in (
        (lineage.HORIZONTAL, grid.interval_x_mrad),
        (lineage.VERTICAL, grid.interval_y_mrad),
    ):

        def mtf(frequency: Vector, line: lineage.Line = line) -> Vector:
            return lineage.all_along(work, stages, line, frequency)

        how: dict[str, Any] = {"mtf": mtf, "sample_mrad": sample_mrad}
        edge = giqe.relative_edge_response(**how), giqe.edge_overshoot(**how)
        results.append((*edge, giqe.edge_response(places_px=_DRAWN, **how)))
    rer, overshoot, response = zip(*results, strict=True)
    return rer, overshoot, response


def signal_over_noise(
    work: Work,
    seen: lineage.ImageNoise,
    *levels: LevelChange,
    gain: float | None,
    gain_before: float,
    snr_of: str,
    reflectance: float | None,
) -> float | Unseen:
    """Signal over the temporal noise; infinite without noise.

    The signal is the mean of the scene's share of the picture, or the contrast of 15 % and 7 %
    reflectance; `reflectance` is that of a sample of 1 of the scene.
    """
    seen.require_known()
    if gain is None:
        raise DataError(
            "the SNR is unknown: gain_model = literal on Electronics & Noise scales the picture by "
            "the gain error. Use gain_model = per_pixel or published"
        )
    of_sample = gain * math.prod(level.per_sample or level.gain for level in levels)
    gain *= math.prod(level.gain for level in levels)
    if clipped := unseen(gain, levels, "there is no signal"):
        return clipped
    if snr_of == "contrast" and reflectance is not None:
        signal = (BRIGHT - DARK) / reflectance * of_sample / gain
    else:
        signal = levels[0].signal / levels[0].gain / gain_before if levels else seen.mean / gain
        if not signal > 0.0:
            raise DataError(
                f"the picture's mean signal is {signal:.6g}, but the SNR needs a signal above zero"
            )
        if snr_of == "contrast":
            signal *= (BRIGHT - DARK) / BRIGHT
    noise = math.sqrt(max(seen.total.temporal, 0.0)) / gain
    return signal / noise if noise > 0.0 else math.inf


def quality_table(
    work: Work,
    edge: tuple[Pair, Pair, Any],
    snr: float | Unseen,
    *,
    across_m: float,
    along_m: float,
    elevation_deg: float,
    typed_rer: tuple[float | None, float | None],
    overshoot: float | None,
    noise_gain: float,
    snr_words: str,
) -> TableData:
    """The equations and what they are made of; those of the noise are empty without a signal.

    The ground sample distances are normal to the line of sight; an RER or overshoot of None is the
    chain's own.
    """
    gsd_m = math.sqrt(across_m * along_m)
    at = {"gsd": gsd_m, "elevation_deg": elevation_deg}
    ground, weighted = float(giqe.ground_gsd(**at)), float(giqe.weighted_gsd(**at))
    rer_x, rer_y = (typed or own for typed, own in zip(typed_rer, edge[0], strict=True))
    rer = _mean("relative edge response", (rer_x, rer_y))
    worse_twice = float(giqe.weighted_rer(rer_x=rer_x, rer_y=rer_y))
    if overshoot is None:
        overshoot = _mean("largest edge response near the edge", edge[1])
    why = snr if isinstance(snr, Unseen) else ""
    fifth = fourth = third = shown_snr = None
    if not isinstance(snr, Unseen):
        known = {"rer": rer, "snr": snr, "overshoot": overshoot, "noise_gain": noise_gain}
        fifth = float(giqe.giqe_5(gsd_inch=weighted / giqe.INCH_M, rer=worse_twice, snr=snr))
        fourth = float(giqe.giqe_4(gsd_inch=ground / giqe.INCH_M, **known))
        third = float(giqe.giqe_3(gsd_inch=gsd_m / giqe.INCH_M, **known))
        shown_snr = snr if math.isfinite(snr) else None
    return TableData.of(
        ("giqe5", fifth, "NIIRS", "GIQE 5, for the picture without sharpening", why),
        ("giqe4", fourth, "NIIRS", "GIQE 4, with overshoot H and noise gain G", why),
        ("giqe3", third, "NIIRS", "GIQE 3, with overshoot H and noise gain G", why),
        ("gsd_m", gsd_m, "m", "ground sample distance normal to the line of sight (GIQE 3)"),
        ("gsd_ground_m", ground, "m", "ground sample distance on the ground (GIQE 4)"),
        ("gsd_weighted_m", weighted, "m",
         "geometric mean of gsd_m and gsd_ground_m (GIQE 5)"),
        ("gsd_inch", gsd_m / giqe.INCH_M, "in",
         "ground sample distance normal to the line of sight"),
        ("elevation_deg", elevation_deg, "deg",
         "elevation of the line of sight, seen from the target"),
        ("rer", rer, "", "relative edge response, geometric mean (GIQE 3 and 4)"),
        ("rer_weighted", worse_twice, "",
         "relative edge response, the worse direction counted twice (GIQE 5)"),
        ("rer_x", rer_x, "", "horizontal relative edge response"),
        ("rer_y", rer_y, "", "vertical relative edge response"),
        ("overshoot", overshoot, "", "edge overshoot H, geometric mean"),
        ("noise_gain", noise_gain, "", "noise gain G of the sharpening"),
        ("snr", shown_snr, "", snr_words, why),
    )  # fmt: skip


def _mean(what: str, values: Pair) -> float:
    if min(values) <= 0.0:
        across, along = values
        raise DataError(
            f"the {what} is {across:.6g} horizontally and {along:.6g} vertically: both must be "
            "above zero for the image quality equations"
        )
    return math.sqrt(values[0] * values[1])


def edge_curve(work: Work, edge: tuple[Pair, Pair, tuple[Vector, Vector]]) -> CurveData:
    across, along = edge[2]
    series = Series("horizontal", _DRAWN, across), Series("vertical", _DRAWN, along)
    return CurveData("Edge response", "distance from the edge (samples)", "response", series)


def limits_caution(work: Work, table: TableData) -> Caution | None:
    figures = table.as_dict()
    values = {name: figures[name] for name in ("gsd_inch", "rer", "overshoot", "snr")}
    if figures["giqe5"] is None:
        return None
    known = {name: math.inf if value is None else float(value) for name, value in values.items()}
    beyond = giqe.beyond_limits(**known)
    if not beyond:
        return None
    return Caution(
        f"outside the limits of GIQE 4: {', '.join(beyond)}", "treat NIIRS as an extrapolation"
    )
