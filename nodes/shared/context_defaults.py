"""A parameter of the module, else the value of Init & Trans or the image, else an error."""

from __future__ import annotations

from dataclasses import replace

from core.chain.wires import Context, Image, Magnitude, Phase
from core.errors import DataError, ParameterError


def given(name: str, own: float | None, context: Context, *, unit: str) -> float:
    """The module's own value, else the context's of the same name."""
    if own is not None:
        return own
    value = getattr(context, name)
    if value is None:
        raise ParameterError(name, None, "give it here or on Init & Trans", unit=unit)
    return float(value)


def of_context(name: str, context: Context, *, unit: str) -> float:
    """The value of Init & Trans, for a module without a parameter of its own for it."""
    value = getattr(context, name)
    if value is None:
        raise ParameterError(name, None, "give it on Init & Trans", unit=unit)
    return float(value)


def given_band(
    cut_on_um: float | None, cut_off_um: float | None, context: Context
) -> tuple[float, float]:
    """The module's own band, each empty end from the image's."""
    of_image = context.band_um or (None, None)
    cut_on = cut_on_um if cut_on_um is not None else of_image[0]
    cut_off = cut_off_um if cut_off_um is not None else of_image[1]
    if cut_on is None:
        raise _no_band("cut_on_um")
    if cut_off is None:
        raise _no_band("cut_off_um")
    if cut_on > cut_off:
        raise ParameterError("cut_off_um", cut_off, f"at least cut_on_um = {cut_on:g}", unit="µm")
    return cut_on, cut_off


def _no_band(name: str) -> ParameterError:
    return ParameterError(name, None, "the image does not say its band: give it here", unit="µm")


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
            f"a transfer function alone has no {wanted}: set apply to multiply upstream"
        )
    if source.key != other.key or magnitude.grid != phase.grid or magnitude.edges != phase.edges:
        raise DataError(
            f"magnitude and phase stem from different images or transforms, which {refusal}: take "
            "Back Transform"
        )
    return source
