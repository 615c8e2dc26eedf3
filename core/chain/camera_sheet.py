"""A camera's data as its sheet gives them: entered once, and carried by the image."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class CameraSheet:
    """What is known of the camera that takes an image; empty fields are None.

    Parameters
    ----------
    pixels_x, pixels_y : int or None
        Pixels of the detector.
    pitch_x_um, pitch_y_um : float or None
        From one pixel to the next.
    focal_length_mm : float or None
        Effective focal length.
    f_number : float or None
        Focal length over aperture, as the radiometry takes it.
    aperture_mm : float or None
        Diameter of the entrance pupil, as diffraction takes it.
    obscuration_ratio : float
        Inner over outer diameter of the aperture, 0 where it is clear.
    fill_x, fill_y : float or None
        Sensitive share of the pitch.
    range_m : float or None
        Distance of the scene.
    """

    pixels_x: int | None = None
    pixels_y: int | None = None
    pitch_x_um: float | None = None
    pitch_y_um: float | None = None
    focal_length_mm: float | None = None
    f_number: float | None = None
    aperture_mm: float | None = None
    obscuration_ratio: float = 0.0
    fill_x: float | None = None
    fill_y: float | None = None
    range_m: float | None = None

    @property
    def pitch_x_mrad(self) -> float | None:
        """Angle from one pixel to the next across."""
        return _angle(self.pitch_x_um, self.focal_length_mm)

    @property
    def pitch_y_mrad(self) -> float | None:
        """Angle from one pixel to the next along."""
        return _angle(self.pitch_y_um, self.focal_length_mm)


def _angle(pitch_um: float | None, focal_length_mm: float | None) -> float | None:
    return pitch_um / focal_length_mm if pitch_um and focal_length_mm else None
