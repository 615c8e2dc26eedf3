"""What the samples of a picture file are in, and the factor that brings radiance to W and m²."""

from __future__ import annotations

from typing import NamedTuple

from core.errors import DataError, FileError, ParameterError
from core.physics.radiometry.radiance_units import RadianceUnit, radiance_unit
from nodes.files.common.picture_info import PictureInfo

DEFAULT_UNIT = "W/m²/sr"


class SampleUnit(NamedTuple):
    """The unit of the samples once they are multiplied by the factor."""

    name: str
    factor: float


def is_spectral(info: PictureInfo) -> bool:
    """Whether a file holds bands that can be summed: not one that is the radiance of a whole."""
    if info.wavelengths_um is None:
        return False
    try:
        unit = radiance_unit(info.unit) if info.unit and info.bands == 1 else None
    except DataError:
        return True
    return unit is None or bool(unit.spectral)


def sample_unit(info: PictureInfo, *, typed: str, scale: float, integrated: bool) -> SampleUnit:
    """Unit of the samples of a file after `scale`.

    The file's own unit holds where it gives one and the scale is 1, else the typed one. Radiance
    comes out in W/m²/sr, W/m²/sr/µm, W/m²/sr/cm⁻¹ or the same in photons/s; every other unit is a
    name that stays as it is. Photons do not become watts: each has its own wavelength.

    Parameters
    ----------
    info
        What is known of the file.
    typed
        The `unit` parameter; empty or `DEFAULT_UNIT` leaves the choice to the file.
    scale
        The `scale` parameter; other than 1 it has turned the samples into the typed unit.
    integrated
        Whether spectral bands were summed up, each times its width in µm.

    Raises
    ------
    FileError
        The file's unit is not understood, or is of photons and none is typed; or there is none, of
        a cube of bands.
    ParameterError
        The typed unit is not understood, or is of another kind of quantity than the file's.
    """
    own = _typed(typed)
    chosen = bool(typed) and own != RadianceUnit(1.0)
    if not info.unit or scale != 1.0:
        if integrated or info.bands > 1:
            _refuse_unnamed(info, named=chosen or scale != 1.0)
        return _of_typed(info, typed, own, integrated)
    try:
        stored = radiance_unit(info.unit)
    except DataError as error:
        if chosen and not integrated:
            return _of_typed(info, typed, own, integrated)
        raise FileError(f"{info.path}: {error.message}; or give unit or scale") from error
    if stored is None:
        return _of_typed(info, typed, own, integrated) if chosen else SampleUnit(info.unit, 1.0)
    file_unit = stored.integrated if integrated else stored
    if not chosen and file_unit.photons:
        raise FileError(
            f"{info.path}: its samples are in {info.unit}, and the energy of a photon depends on "
            f"its wavelength; give unit = {file_unit.name} to keep photons, or scale for watts"
        )
    if chosen and (own is None or own.name != file_unit.name):
        allowed = f"a unit of the same kind as {info.unit}, in which the file is; or give scale"
        raise ParameterError("unit", typed, allowed)
    return SampleUnit(file_unit.name, file_unit.factor)


def spectral_unit(info: PictureInfo, *, typed: str, scale: float) -> RadianceUnit | None:
    """Unit of the samples of a file's bands times `scale`; None where they are no radiance.

    As in `sample_unit` the file's own unit holds where it gives one and the scale is 1. A radiance
    typed without a share of wavelength is per µm.

    Raises
    ------
    FileError
        The file's unit is not understood, or there is none.
    ParameterError
        The typed unit is not understood, or is of another kind of quantity than the file's.
    """
    own = _typed(typed)
    chosen = bool(typed) and own != RadianceUnit(1.0)
    if info.unit and scale == 1.0:
        try:
            stored = radiance_unit(info.unit)
        except DataError as error:
            raise FileError(f"{info.path}: {error.message}; or give unit and scale") from error
        if chosen and (own is None) != (stored is None):
            allowed = f"a unit of the same kind as {info.unit}, in which the file is; or give scale"
            raise ParameterError("unit", typed, allowed)
        if not chosen or own is None or stored is None or own.name == stored.name:
            return stored
        allowed = f"a unit of the same kind as {info.unit}, in which the file is; or give scale"
        raise ParameterError("unit", typed, allowed)
    _refuse_unnamed(info, named=chosen or scale != 1.0)
    if own is None or own.spectral:
        return own
    return RadianceUnit(own.factor, own.photons, "µm")


def _refuse_unnamed(info: PictureInfo, *, named: bool) -> None:
    """Refuse the cube of a file of which nobody says what its samples are in."""
    if info.kind == "envi" and info.wavelengths_um and not info.unit and not named:
        raise FileError(
            f"{info.path}: its header has no data units: add a line such as data units = "
            "W/m^2/sr/um, or set unit to what the samples are in, such as W/cm²/sr/µm or DN"
        )


def _typed(text: str) -> RadianceUnit | None:
    try:
        return radiance_unit(text)
    except DataError as error:
        raise ParameterError("unit", text, error.message.partition("; ")[2]) from error


def _of_typed(
    info: PictureInfo, typed: str, own: RadianceUnit | None, integrated: bool
) -> SampleUnit:
    if own is None:
        return SampleUnit(typed, 1.0)
    if not integrated or not own.spectral:
        return SampleUnit(own.name, own.factor)
    if own.spectral != "µm":
        raise ParameterError("unit", typed, "per µm or nm, where bands are integrated over µm")
    # The sum over the bands took the samples per µm, or as the file gives it.
    stored = radiance_unit(info.unit) if info.unit else None
    taken = stored.per_um if stored is not None else 1.0
    return SampleUnit(RadianceUnit(1.0, own.photons).name, own.factor / taken)
