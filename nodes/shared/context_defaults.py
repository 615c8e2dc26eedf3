"""A parameter of the module, else the value of Init & Trans or the image, else an error."""

from core.chain.wires import Context, Image, Magnitude, Phase
from core.errors import DataError, ParameterError
from core.modules.declaration import Module
from core.modules.parameters import Caution
from core.physics.detector.focal_plane_array import Irradiance, solid_angle
from core.physics.sampling.detector_sampling import ifov_mrad
from core.records import dataclass, replace

Band = tuple[float, float]


def given(name: str, own: float | None, context: Context) -> float:
    """The module's own value, else the context's of the same name."""
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


def pixel_mrad(axis: str, context: Context) -> float:
    """Angle from pixel to pixel."""
    pitch = of_context(f"detector_{axis}_um", context)
    return ifov_mrad(pitch_um=pitch, focal_length_mm=of_context("focal_length_mm", context))


def pixel_of(context: Context) -> dict[str, float]:
    """Pitches and fill factors of a pixel."""
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
        """Of the exit pupil, seen from a pixel."""
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


def t_number_caution(context: Context, optics_transmission: float) -> Caution | None:
    """A transmission beside a T-number, which holds one already."""
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
            raise ParameterError(name, None, "the image has no band: give a value here")
    assert low is not None
    assert high is not None
    if not (low <= high if empty else low < high):
        wanted = f"at least cut_on_um = {low:g}" if empty else f"above cut_on_um = {low:g}"
        raise ParameterError("cut_off_um", high, wanted)
    return low, high


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
    """The one image that both wires belong to.

    `wanted` and `refusal` are for people: what there has to be, and what does not do with two
    images.
    """
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
