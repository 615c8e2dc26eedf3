"""A parameter of the module, else the value of Init & Trans; and where both differ."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from core.chain.wires import Context, Image, Magnitude, Phase
from core.errors import DataError, ParameterError, unit_of
from core.modules.declaration import Caution, Module, declaration, warning
from core.physics.detector.focal_plane_array import Irradiance, solid_angle
from core.physics.radiometry.radiance_units import RadianceUnit, radiance_unit
from core.physics.sampling.detector_sampling import ifov_mrad, interval_mrad
from core.records import dataclass, replace

Band = tuple[float, float]


def given(name: str, own: float | None, context: Context) -> float:
    if own is not None:
        return own
    return of_context(name, context, where="here or on Init & Trans")


def check_given(module: Module, context: Context, *names: str) -> None:
    """Refuse at once all parameters that neither the module nor Init & Trans has."""
    empty = [n for n in names if getattr(module, n) is None and getattr(context, n) is None]
    if empty:
        wanted = f"give {'values' if empty[1:] else 'a value'} here or on Init & Trans"
        raise ParameterError(empty[0], None, wanted, also=empty[1:])


def of_context(name: str, context: Context, *, where: str = "on Init & Trans") -> float:
    """The value of Init & Trans, for a module without a parameter of its own for it."""
    value = getattr(context, name)
    if value is None:
        raise ParameterError(name, None, f"give a value {where}")
    return float(value)


def interval_of(name: str, fov_deg: float | None, samples: int) -> float | None:
    return None if fov_deg is None else interval_mrad(fov_deg=fov_deg, samples=samples, name=name)


def pixel_mrad(axis: str, context: Context) -> float:
    pitch = of_context(f"detector_{axis}_um", context)
    return ifov_mrad(pitch_um=pitch, focal_length_mm=of_context("focal_length_mm", context))


def pixel_of(context: Context) -> dict[str, float]:
    pitches = {f"pitch_{axis}_um": of_context(f"detector_{axis}_um", context) for axis in "xy"}
    return {**pitches, "fill_x": context.fill_x, "fill_y": context.fill_y}


def pitch_in_samples(axis: str, image: Image) -> float | None:
    """Detector pitch over the image's sampling interval, where both are known."""
    pitch = image.pixel_mrad[0 if axis == "x" else 1]
    interval = image.interval_x_mrad if axis == "x" else image.interval_y_mrad
    return pitch / interval if pitch and interval else None


@dataclass(frozen=True)
class Lens:
    """The light of a lens: transmission times the solid angle of this cone.

    A T-number is the F-number of a clear, lossless lens; where the F-number is known too, the cone
    is that of the F-number and the transmission follows.
    """

    f_number: float
    obscuration_ratio: float
    irradiance: Irradiance
    transmission: float

    @property
    def solid_angle_sr(self) -> float:
        return solid_angle(
            f_number=self.f_number,
            obscuration_ratio=self.obscuration_ratio,
            irradiance=self.irradiance,
        )


def lens(context: Context, *, optics_transmission: float, f_number: float | None = None) -> Lens:
    """The lens of Camera and Init & Trans; a module's own F-number counts before theirs."""
    number = f_number or context.f_number
    obscured = context.obscuration_ratio
    if context.t_number is None:
        if number is None:
            raise ParameterError("f_number", None, "give a value on Init & Trans")
        return Lens(number, obscured, context.irradiance, optics_transmission)
    clear = Lens(context.t_number, 0.0, context.irradiance, 1.0)
    if number is None:
        return clear
    lossless = Lens(number, obscured, context.irradiance, 1.0)
    share = clear.solid_angle_sr / lossless.solid_angle_sr
    return replace(lossless, transmission=share) if share <= 1.0 else clear


@warning
def t_number_warning(module: Any, context: Context) -> Caution | None:
    """The transmission is not used, because the T-number includes it."""
    optics_transmission = module.optics_transmission
    if context.t_number is None or optics_transmission == 1.0:
        return None
    own = lens(context, optics_transmission=1.0).transmission
    if abs(own - optics_transmission) <= 0.01 * optics_transmission:
        return None
    return Caution(
        f"optics_transmission = {optics_transmission:g} is not used: t_number = "
        f"{context.t_number:g} on Camera already includes the transmission"
        + (f", {own:.4g}" if own != 1.0 else ""),
        "set optics_transmission to 1, or leave t_number on Camera empty",
    )


def given_band(
    cut_on_um: float | None, cut_off_um: float | None, of_image: Band | None, *, empty: bool = True
) -> Band:
    """The module's own band, each empty end from the image's; `empty`: both ends may be one."""
    low, high = (
        own if own is not None else of_image and of_image[end]
        for end, own in enumerate((cut_on_um, cut_off_um))
    )
    for name, value in (("cut_on_um", low), ("cut_off_um", high)):
        if value is None:
            raise ParameterError(name, None, "the image has no band; give a value here")
    assert low is not None
    assert high is not None
    if not (low <= high if empty else low < high):
        wanted = f"at least cut_on_um = {low:g}" if empty else f"above cut_on_um = {low:g}"
        raise ParameterError("cut_off_um", high, wanted)
    return low, high


def filled_band(cut_on_um: float | None, cut_off_um: float | None, of_image: Band) -> Band:
    """The module's own band, each empty end from the image's, whatever they are."""
    low, high = of_image
    return low if cut_on_um is None else cut_on_um, high if cut_off_um is None else cut_off_um


def with_interval(image: Image, context: Context) -> Image:
    """The image with its sampling interval: of the field of view where it has none."""
    if image.interval_x_mrad is not None and image.interval_y_mrad is not None:
        return image
    grid = context.grid
    return replace(
        image,
        interval_x_mrad=grid.interval_x_mrad * grid.columns / image.columns,
        interval_y_mrad=grid.interval_y_mrad * grid.rows / image.rows,
    )


def one_source(magnitude: Magnitude, phase: Phase, *, wanted: str, refusal: str) -> Image:
    """The one image that both wires belong to; `wanted` and `refusal` are words for people."""
    source, other = magnitude.image, phase.image
    if source is None or other is None:
        raise DataError(
            f"a transfer function alone has no {wanted}: set apply to multiply in the modules "
            "before this node"
        )
    if source.key != other.key or magnitude.grid != phase.grid or magnitude.edges != phase.edges:
        raise DataError(
            f"magnitude and phase come from different images or transforms, which {refusal}: "
            "use Back Transform"
        )
    return source


# What modules warn of: values that two places give differently, and units that do not fit.

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


def unit_warning(meant: str) -> Any:
    def unit(_: Module, image: Image) -> Caution | None:
        """The picture is not in units of radiance."""
        return unit_caution(image.unit, meant=meant)

    return warning(unit)


@warning
def band_warning(module: Any, image: Image) -> Caution | None:
    """The band entered here differs from the picture's band."""
    picture = image.band_um
    if picture is None or (module.cut_on_um is None and module.cut_off_um is None):
        return None
    low, high = filled_band(module.cut_on_um, module.cut_off_um, picture)
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
    picture: Band | None, wavelength_um: float | None, *, name: str, empty: str = ""
) -> Caution | None:
    """A wavelength outside the picture's band; `empty` are the parameters to leave empty."""
    if picture is None or wavelength_um is None:
        return None
    low, high = picture
    if low * (1 - NEAR) <= wavelength_um <= high * (1 + NEAR):
        return None
    return Caution(
        f"{name} = {wavelength_um:g} µm lies outside the picture's band, {_band(picture)}",
        f"leave {empty or name} empty to use the picture's band, or correct the picture's band",
    )


@warning
def middle_warning(module: Any, context: Context) -> Caution | None:
    """Diffraction is computed for wavelengths outside the picture's band."""
    picture = context.band_um
    if picture is None or (module.cut_on_um is None and module.cut_off_um is None):
        return None
    middle = sum(filled_band(module.cut_on_um, module.cut_off_um, picture)) / 2
    name = "the band centre, (cut_on_um + cut_off_um)/2"
    ends = "cut_on_um and cut_off_um"
    return wavelength_caution(picture, middle, name=name, empty=ends)


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
    """A value of two places that differs by more than `near` of the larger; empty is none."""
    if not own or not other or alike(own, other, near=near):
        return None
    unit = f" {unit or unit_of(name)}".rstrip()
    return Caution(
        f"{name} = {own:.4g}{unit} here but {other:.4g}{unit} {where}",
        remedy
        or f"leave {name} empty to use the value {where}; ignore this warning if the "
        "difference is intended",
    )


def apart(module: Module, others: Mapping[str, float | None], **how: Any) -> Caution | None:
    """The first of these parameters that is not the value of another place, as `apart_caution`."""
    units = {p.name: p.param.unit for p in declaration(type(module)).parameters}
    values, pairs = module.values(), others.items()
    return first(*(apart_caution(n, values[n], one, unit=units[n], **how) for n, one in pairs))


def apart_from_context(
    module: Module, context: Context, *names: str, where: str = "on Init & Trans"
) -> Caution | None:
    """The first of these parameters that is not the one of Init & Trans."""
    return apart(module, {name: getattr(context, name) for name in names}, where=where)


ELECTRONICS = "on Init & Trans (used by the electronics)"


def alike(one: float, other: float, *, near: float = NEAR) -> bool:
    return abs(one - other) <= near * max(abs(one), abs(other))


def context_warning(meaning: str, names: str, *, where: str = "on Init & Trans") -> Any:
    """A warning of parameters, named one behind the other, that are not those of Init & Trans."""

    def differs(module: Module, context: Context) -> Caution | None:
        return apart_from_context(module, context, *names.split(), where=where)

    differs.__doc__ = meaning
    return warning(differs)


@warning
def phase_warning(module: Any, outputs: Any) -> Caution | None:
    """The PTF is not applied to the picture."""
    linked = outputs.phase.image is not None
    if module.apply != "multiply" or linked or not outputs.ptf.factors:
        return None
    return Caution(
        "the PTF is left out of the picture: phase is not connected",
        "connect phase from Init & Trans to this node, and on to Back Transform",
    )


def first(*cautions: Caution | None) -> Caution | None:
    return next((caution for caution in cautions if caution is not None), None)


def _band(band: Band) -> str:
    return f"{band[0]:g} to {band[1]:g} µm"
