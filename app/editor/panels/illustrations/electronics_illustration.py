"""Electronics & Noise: D* of the detector against wavelength, and its noise in kelvin."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter

from app.editor.evaluation.queries import Passing, Query
from app.editor.panels.illustrations.chart import Axis, Bar, Chart, brief, kelvin, paint_bars
from app.editor.panels.illustrations.illustration import Illustration
from core.chain.engine import Plan, PlannedNode
from core.chain.wires import Context
from core.errors import ImagechainError, ParameterError
from core.physics.detector.detectivity import (
    STANDARD_HALF_ANGLE_DEG,
    cold_shield_half_angle_deg,
    d_star,
)
from core.physics.radiometry.spectra import MANUAL, Material, find_material
from nodes.shared.context_defaults import given_band

_DECADES = 2.3  # below the highest D* that are shown
_SOLID, _DASHED = Qt.PenStyle.SolidLine, Qt.PenStyle.DashLine


class ElectronicsIllustration(Illustration):
    """The curve of the material, the band and the D* taken from it, and NETDs as bars."""

    lines = 15.5

    def queries(self) -> Sequence[Query]:
        return (DetectivityQuery(self.node),)

    def keep(self, value: Detectivity) -> str:
        self._detectivity = value
        missing = self.missing_inputs()
        self._note = f"not connected yet: {', '.join(missing)}" if missing else value.problem
        return in_words(value, self._note)

    def draw(self, painter: QPainter, area: QRectF) -> None:
        line = QFontMetricsF(painter.font()).height()
        below = line * 3.4
        detectivity = self._detectivity
        self._chart(painter, area.adjusted(0, 0, 0, -below), detectivity)
        bars = QRectF(area.left(), area.bottom() - below + line * 0.2, area.width(), line * 3.2)
        if detectivity.noises is not None:
            self._bars(painter, bars, detectivity.noises)
        else:
            painter.setPen(QColor(self.theme.faint_text))
            wrapped = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(bars, int(wrapped), self._note)

    def _chart(self, painter: QPainter, area: QRectF, detectivity: Detectivity) -> None:
        theme = self.theme
        chart = Chart(painter, area, *axes(detectivity), theme)
        if detectivity.band_um is not None:
            chart.band(*detectivity.band_um, theme.accent)
        first, second = theme.curves[:2]
        line = self.fontMetrics().height()
        entries = []
        if detectivity.peak is not None:
            style = Qt.PenStyle.DotLine if detectivity.typed else _SOLID
            values = np.where(detectivity.values > 0, detectivity.values, 1e-3)
            chart.curve(detectivity.wavelength_um, values, first, style)
            chart.point(detectivity.peak.wavelength_um, detectivity.peak.d_star, first)
            at = chart.at(detectivity.peak.wavelength_um, detectivity.peak.d_star)
            at.setY(max(at.y() - line * 0.8, chart.frame.top() + line * 0.6))
            chart.text(
                at,
                f"{brief(detectivity.peak.d_star)} at {brief(detectivity.peak.wavelength_um)} µm",
            )
            entries.append((detectivity.material, first, style))
        if detectivity.band_d_star is not None:
            ends = detectivity.band_um or (chart_end(detectivity) * 0.02, chart_end(detectivity))
            chart.curve(ends, (detectivity.band_d_star,) * 2, second, _DASHED, 2.0)
            at = chart.at(ends[0], detectivity.band_d_star)
            at.setY(at.y() + line * 0.8)
            chart.text(at, brief(detectivity.band_d_star))
            entries.append(("typed in" if detectivity.typed else "band", second, _DASHED))
        chart.legend(entries)

    def _bars(self, painter: QPainter, area: QRectF, noises: Noises) -> None:
        """NETDs, as long as they are large."""
        colours = self.theme.curves
        rows = (
            ("NETD detector", noises.detector_K, colours[2]),
            ("amplifier", noises.amplifier_K, colours[3]),
            ("system", noises.system_K, colours[0]),
        )
        bars = [Bar(name, value, kelvin(value), colour) for name, value, colour in rows]
        paint_bars(painter, area, bars, self.theme)


def chart_end(detectivity: Detectivity) -> float:
    """The longest wavelength shown, µm."""
    ends = [*(detectivity.band_um or ()), *detectivity.wavelength_um[-1:]]
    return 1.08 * max(ends, default=14.0)


def axes(detectivity: Detectivity) -> tuple[Axis, Axis]:
    """Wavelength, and two decades of D*."""
    levels = [detectivity.peak.d_star] if detectivity.peak is not None else []
    if detectivity.band_d_star:
        levels.append(detectivity.band_d_star)
    high, low = max(levels, default=1e12), min(levels, default=1e12)
    across = Axis(0.0, chart_end(detectivity), f"wavelength (µm), {detectivity.conditions}")
    shown = max(10**_DECADES, 10 * high / low)
    return across, Axis(high / shown, high * 6.0, "D* (cm √Hz/W)", log=True)


def in_words(detectivity: Detectivity, note: str) -> str:
    """The essential numbers."""
    parts = []
    if detectivity.peak is not None:
        parts.append(
            f"D* of {detectivity.material}: peak {brief(detectivity.peak.d_star)} cm √Hz/W at "
            f"{brief(detectivity.peak.wavelength_um)} µm, seeing {detectivity.conditions}"
        )
    if detectivity.band_d_star is not None:
        where = "typed in" if detectivity.typed else "of the band"
        parts.append(f"D* {where} {brief(detectivity.band_d_star)} cm √Hz/W")
    if detectivity.noises is not None:
        noises = detectivity.noises
        parts.append(
            f"NETD detector {kelvin(noises.detector_K)}, amplifier {kelvin(noises.amplifier_K)}, "
            f"system {kelvin(noises.system_K)}"
        )
    elif note:
        parts.append(note)
    return "; ".join(parts)


# The query for D*(λ) of an Electronics & Noise node, and for its noise in kelvin.

Vector = NDArray[np.float64]
SAMPLES = 241
STANDARD_BACKGROUND_K = 300.0
_SHORTEST = 0.15  # wavelengths from that share of the cut-off on


@dataclass(frozen=True)
class Peak:
    """Where D* is highest in the band, µm, and how high, cm √Hz/W."""

    wavelength_um: float
    d_star: float


@dataclass(frozen=True)
class Noises:
    """NETD of the detector, the amplifier and both together, K."""

    detector_K: float
    amplifier_K: float
    system_K: float


@dataclass(frozen=True, eq=False)
class Detectivity:
    """D* against wavelength."""

    material: str  # name of the material; `manual` has no curve
    # wavelength_um, values: shape (points,): µm; cm √Hz/W, 0 beyond the cut-off
    wavelength_um: Vector
    values: Vector
    peak: Peak | None  # of the curve in the band
    conditions: str  # what the detector sees
    band_um: tuple[float, float] | None  # cut-on and cut-off, where known
    band_d_star: float | None  # D* that the noise is computed with
    typed: bool  # whether that was typed in, in place of the material's
    noises: Noises | None  # where they can be computed
    problem: str = ""  # why they cannot


@dataclass(frozen=True)
class DetectivityQuery(Query):
    """D*(λ) of the node's detector, D* in the band, and the noise computed from it.

    Without a picture, the curve is that of the makers' conditions.
    """

    urgency: ClassVar[int] = 1

    node: str

    def key(self, plan: Plan) -> Hashable:
        planned = plan.node(self.node)
        table = planned.outputs.get("table")
        if planned.error is None and table is not None:
            return table.key, planned.node.disabled
        context = planned.inputs.get("context")
        return repr(planned.module), str(planned.error), context and context.key, planned.node

    def answer(self, passing: Passing) -> Detectivity:
        planned = _built(passing, passing.plan.node(self.node))
        try:
            figures, problem = _figures(planned, passing), ""
        except ImagechainError as error:
            figures, problem = {}, str(error) if error.node != self.node else error.message
        return _detectivity(planned, figures, problem)


def _built(passing: Passing, planned: PlannedNode) -> PlannedNode:
    """The node with its module, which one that is not connected yet has not."""
    if planned.module is not None:
        return planned
    module = passing.engine.library[planned.node.module].build(planned.node.params)
    return replace(planned, module=module)


def _figures(planned: PlannedNode, passing: Passing) -> dict[str, Any]:
    if planned.error is not None:
        raise planned.error
    table = planned.outputs.get("table")
    return passing.work.value(table.recipe).as_dict() if table is not None else {}


def _detectivity(planned: PlannedNode, figures: dict[str, Any], problem: str) -> Detectivity:
    module: Any = planned.module
    context: Context | None = planned.inputs.get("context")
    band = _band(module, context)
    background, half_angle = STANDARD_BACKGROUND_K, STANDARD_HALF_ANGLE_DEG
    if figures and context is not None and context.f_number is not None:
        background = figures["background_K"]
        half_angle = cold_shield_half_angle_deg(f_number=context.f_number)
        seen = f"F/{context.f_number:.3g}"
    else:
        seen = f"a cone of {2 * half_angle:.0f}°"
    wavelength, values, peak = np.zeros(0), np.zeros(0), None
    if module.material != MANUAL:
        cut_off = band[1] if band is not None else None
        material = find_material(region=module.region, material=module.material, cut_off_um=cut_off)
        wavelength, values = curve(material, background, half_angle)
        seen_by = {"background_K": background, "half_angle_deg": half_angle}
        peak = peak_of(material, wavelength, values, band, seen_by)
    noises = None
    if figures:
        names = ("netd_detector_K", "netd_amplifier_K", "netd_system_K")
        noises = Noises(*(float(figures[name]) for name in names))
    return Detectivity(
        material=module.material,
        wavelength_um=wavelength,
        values=values,
        peak=peak,
        conditions=f"{background:.0f} K in {seen}",
        band_um=band,
        band_d_star=figures.get("d_star", module.d_star),
        typed=module.d_star is not None,
        noises=noises,
        problem=problem,
    )


def curve(material: Material, background_K: float, half_angle_deg: float) -> tuple[Vector, Vector]:
    """Wavelengths up to the cut-off, which is the last but one point, and D* there."""
    cut_off = material.cut_off_um
    inside = np.linspace(_SHORTEST * cut_off, cut_off, SAMPLES)
    wavelength = np.append(inside, np.nextafter(cut_off, np.inf))
    seen = {"background_K": background_K, "half_angle_deg": half_angle_deg}
    return wavelength, d_star(wavelength, material=material, **seen)


def peak_of(
    material: Material,
    wavelength: Vector,
    values: Vector,
    band_um: tuple[float, float] | None,
    seen: Mapping[str, float],
) -> Peak:
    """The highest D* in the band, or of the curve where it has none there."""
    if band_um is not None and 0 < band_um[0] < material.cut_off_um:
        end = min(band_um[1], material.cut_off_um)
        wavelength = np.append(np.linspace(band_um[0], end, SAMPLES)[:-1], end)
        values = d_star(wavelength, material=material, **seen)
    highest = int(np.argmax(values))
    return Peak(float(wavelength[highest]), float(values[highest]))


def _band(module: Any, context: Context | None) -> tuple[float, float] | None:
    try:
        if context is not None:
            return given_band(module.cut_on_um, module.cut_off_um, context.band_um)
    except ParameterError:
        return None
    on, off = module.cut_on_um, module.cut_off_um
    return (on, off) if on is not None and off is not None and on <= off else None
