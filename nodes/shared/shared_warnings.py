"""What modules warn of: values that two places give differently, and units that do not fit."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from core.chain.wires import Context, Phase, Transfer
from core.errors import DataError, unit_of
from core.modules.declaration import Caution, Module, declaration
from core.physics.radiometry.radiance_units import RadianceUnit, radiance_unit

Band = tuple[float, float]
NEAR = 0.01  # values that were meant to be the same differ by rounding alone
F_NUMBER_NEAR = 0.05  # nominal F numbers are rounded: F/5.6 is 5.657
_BANDS_ALIKE = 0.9  # overlap over both bands together
_TEMPERATURES = ("K", "°C", "C", "degC", "kelvin", "mK", "°F")


@lru_cache(maxsize=64)
def is_radiance(unit: str) -> bool:
    """Whether a unit, however it is worded, is W/m²/sr: of radiance integrated over a band."""
    try:
        return radiance_unit(unit) == RadianceUnit(1.0)
    except DataError:
        return False


def is_temperature(unit: str) -> bool:
    return unit.strip() in _TEMPERATURES


def watts_factor(unit: str, *, temperature: str, needed: str) -> float:
    """What makes W/m²/sr of a picture's samples; refused if they are not a band's radiance."""
    known = None if is_temperature(unit) or not unit.strip() else radiance_unit(unit)
    if known is None or known.photons or known.spectral:
        named = f"in {unit!r:.40}" if unit.strip() else "without a unit"
        what = temperature if is_temperature(unit) else "not the radiance of a band in watts"
        raise DataError(f"the picture, {named}, is {what}: {needed}")
    return known.factor


def unit_caution(unit: str, *, meant: str) -> Caution | None:
    """A picture that is no radiance, where a module takes it for one, or makes `meant` of it."""
    if is_radiance(unit):
        return None
    named = f"is in {unit!r:.40}" if unit.strip() else "has no unit"
    return Caution(
        f"the picture {named}; radiance in W/m²/sr is required for {meant}",
        "put To Radiance before this node to convert temperatures to radiance"
        if is_temperature(unit)
        else "convert the picture with scale and unit on Read Image",
    )


def band_caution(
    picture: Band | None, cut_on_um: float | None, cut_off_um: float | None
) -> Caution | None:
    """A band of a module that is not the picture's, whose radiance it takes."""
    if picture is None or (cut_on_um is None and cut_off_um is None):
        return None
    low = picture[0] if cut_on_um is None else cut_on_um
    high = picture[1] if cut_off_um is None else cut_off_um
    both = min(high, picture[1]) - max(low, picture[0])
    whole = max(high, picture[1]) - min(low, picture[0])
    if both >= _BANDS_ALIKE * whole:
        return None
    apart = f"overlap by {100 * both / whole:.0f} % of their total width"
    if both <= 0:
        apart = "do not overlap"
    return Caution(
        f"the picture's radiance covers {_band(picture)}, but cut_on_um to cut_off_um is "
        f"{_band((low, high))}: the bands {apart}",
        "leave cut_on_um and cut_off_um empty to use the picture's band, or set the picture's "
        "band to match",
    )


def wavelength_caution(
    picture: Band | None, wavelength_um: float | None, *, name: str
) -> Caution | None:
    """A wavelength outside the picture's band."""
    if picture is None or wavelength_um is None:
        return None
    low, high = picture
    if low * (1 - NEAR) <= wavelength_um <= high * (1 + NEAR):
        return None
    return Caution(
        f"{name} = {wavelength_um:g} µm lies outside the picture's band, {_band(picture)}",
        "leave the wavelengths empty to use the picture's band, or correct the picture's band",
    )


def middle_caution(
    picture: Band | None, cut_on_um: float | None, cut_off_um: float | None
) -> Caution | None:
    """A band of a module whose middle lies outside the picture's; an empty end is that."""
    if picture is None or (cut_on_um is None and cut_off_um is None):
        return None
    low = picture[0] if cut_on_um is None else cut_on_um
    high = picture[1] if cut_off_um is None else cut_off_um
    name = "the band centre, (cut_on_um + cut_off_um)/2"
    return wavelength_caution(picture, (low + high) / 2, name=name)


def apart_caution(
    name: str,
    own: float | None,
    other: float | None,
    *,
    where: str,
    unit: str = "",
    near: float = NEAR,
    remedy: str = "",
) -> Caution | None:
    """A value that two places give differently; none where one of them is empty or 0.

    They may differ by the share `near` of the larger. The remedy is to leave this one empty, if
    none is given.
    """
    if not own or not other or alike(own, other, near=near):
        return None
    unit = f" {unit or unit_of(name)}".rstrip()
    return Caution(
        f"{name} = {own:.4g}{unit} here but {other:.4g}{unit} {where}",
        remedy
        or f"leave {name} empty to use the value {where}; ignore this warning if the "
        "difference is intended",
    )


def apart(
    module: Module,
    others: Mapping[str, float | None],
    *,
    where: str,
    near: float = NEAR,
    remedy: str = "",
) -> Caution | None:
    """The first of these parameters that is not the value of another place."""
    units = {p.name: p.param.unit for p in declaration(type(module)).parameters}
    how: dict[str, Any] = {"where": where, "near": near, "remedy": remedy}
    values = module.values()
    return first(
        *(
            apart_caution(name, values[name], other, unit=units[name], **how)
            for name, other in others.items()
        )
    )


def apart_from_context(
    module: Module, context: Context, *names: str, where: str = "on Init & Trans"
) -> Caution | None:
    """The first of these parameters that is not the one of Init & Trans."""
    return apart(module, {name: getattr(context, name) for name in names}, where=where)


ELECTRONICS = "on Init & Trans (used by the electronics)"


def alike(one: float, other: float, *, near: float = NEAR) -> bool:
    """Whether two values differ by no more than that share of the larger."""
    return abs(one - other) <= near * max(abs(one), abs(other))


def unlinked_phase_caution(apply: str, phase: Phase, ptf: Transfer) -> Caution | None:
    """A PTF that is left out because no phase is linked; alone (`apply`) it needs none."""
    if apply != "multiply" or phase.image is not None or not ptf.factors:
        return None
    return Caution(
        "the PTF is left out of the picture: phase is not connected",
        "connect phase from Init & Trans to this node, and on to Back Transform",
    )


def first(*cautions: Caution | None) -> Caution | None:
    return next((caution for caution in cautions if caution is not None), None)


def _band(band: Band) -> str:
    return f"{band[0]:g} to {band[1]:g} µm"
