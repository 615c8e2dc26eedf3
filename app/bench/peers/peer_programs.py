"""How the other programs do the task, as in their documentation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.bench.peers.peer_imports import load

Array = NDArray[Any]
Deliver = Callable[[Array], Array]


@dataclass(frozen=True)
class Task:
    """A frame of `size`² samples, a circular aperture and a square pixel."""

    size: int
    aperture_mm: float = 90.0
    wavelength_um: float = 4.0
    focal_length_mm: float = 200.0
    pixel_um: float = 20.0

    @property
    def interval_mrad(self) -> float:
        """Sampling interval: a quarter of the cutoff's period."""
        return self.wavelength_um / (4 * self.aperture_mm)

    @property
    def pixel_mrad(self) -> float:
        """Angle of the pixel."""
        return self.pixel_um / self.focal_length_mm


@dataclass(frozen=True)
class Noted:
    """A way to deliver, with a note on it."""

    deliver: Callable[[Array], Array]
    note: str = ""

    def __call__(self, frame: Array) -> Array:
        """The frame filtered."""
        return self.deliver(frame)


RANGE_M = 1000.0


def _pybsm_sensor(task: Task) -> tuple[Any, Any, float]:
    simulation = load("pybsm.simulation")
    around = task.wavelength_um * 1e-6
    sensor = simulation.Sensor(
        name="sensor",
        D=task.aperture_mm * 1e-3,
        f=task.focal_length_mm * 1e-3,
        # As many samples out as in: nothing is resampled.
        p_x=task.interval_mrad * 1e-3 * task.focal_length_mm * 1e-3,
        w_x=task.pixel_um * 1e-6,
        w_y=task.pixel_um * 1e-6,
        opt_trans_wavelengths=np.array([0.99 * around, 1.01 * around]),
    )
    scenario = simulation.Scenario(
        name="scenario", ihaze=1, altitude=RANGE_M, ground_range=0.0, cn2_at_1m=0.0
    )
    return sensor, scenario, task.interval_mrad * 1e-3 * RANGE_M


def pybsm_simulate_image(task: Task) -> Deliver:
    """The function `simulate_image`; its blurred picture, back on the scale of the frame."""
    simulation = load("pybsm.simulation")
    sensor, scenario, gsd = _pybsm_sensor(task)

    def deliver(frame: Array) -> Array:
        low, high = float(frame.min()), float(frame.max())
        reference = simulation.RefImage(
            img=frame,
            gsd=gsd,
            pix_values=np.array([low, high]),
            refl_values=np.array([0.05, 0.95]),
        )
        ideal, blurred, _ = simulation.simulate_image(
            ref_img=reference, sensor=sensor, scenario=scenario
        )
        scale = (high - low) / (float(ideal.max()) - float(ideal.min()))
        return np.asarray((blurred - float(ideal.min())) * scale + low)

    return deliver


def pybsm_cached(task: Task) -> Deliver:
    """`SystemOTFSimulator`, which keeps its PSF."""
    sensor, scenario, gsd = _pybsm_sensor(task)
    simulator = load("pybsm.simulation.image_simulator").SystemOTFSimulator(
        sensor=sensor,
        scenario=scenario,
        mtf_wavelengths=np.array([task.wavelength_um * 1e-6]),
        mtf_weights=np.array([1.0]),
        do_resample=False,
    )

    def deliver(frame: Array) -> Array:
        return np.asarray(simulator.simulate_image(frame, gsd)[1])

    return deliver


def galsim_with(interpolant: str) -> Callable[[Task], Deliver]:
    """An interpolated image convolved with an Airy function and a pixel."""

    def build(task: Task) -> Deliver:
        galsim: Any = load("galsim")
        airy = galsim.Airy(lam_over_diam=task.wavelength_um / task.aperture_mm)
        pixel = galsim.Pixel(task.pixel_mrad)

        def deliver(frame: Array) -> Array:
            image = galsim.Image(np.asarray(frame), scale=task.interval_mrad, xmin=0, ymin=0)
            scene = galsim.InterpolatedImage(image, x_interpolant=interpolant)
            drawn = galsim.Image(task.size, task.size, scale=task.interval_mrad)
            blurred = galsim.Convolve([scene, airy, pixel])
            blurred.drawImage(image=drawn, method="no_pixel")
            return np.asarray(drawn.array)

        return deliver

    return build


def prysm_pupil(task: Task) -> Deliver:
    """A sampled pupil to its PSF and MTF, which multiplies the frame's spectrum."""
    coordinates: Any = load("prysm.coordinates")
    geometry: Any = load("prysm.geometry")
    otf: Any = load("prysm.otf")
    propagation: Any = load("prysm.propagation")
    psf_um = task.interval_mrad * task.focal_length_mm
    # As wide an array that the PSF has the frame's interval, and so the MTF its frequencies.
    pitch_mm = task.wavelength_um * task.focal_length_mm / (task.size * psf_um)
    frequency = np.fft.fftfreq(task.size, task.interval_mrad)
    pixel = np.sinc(task.pixel_mrad * frequency)

    def deliver(frame: Array) -> Array:
        x, y = coordinates.make_xy_grid(task.size, dx=pitch_mm)
        radius, _ = coordinates.cart_to_polar(x, y)
        pupil = geometry.circle(task.aperture_mm / 2, radius)
        psf = np.abs(propagation.focus(pupil.astype(np.complex128), Q=1)) ** 2
        mtf = np.fft.ifftshift(otf.mtf_from_psf(psf, psf_um).data)
        response = mtf * np.outer(pixel, pixel)
        return np.real(np.fft.ifft2(np.fft.fft2(frame) * response))

    return deliver


PEERS: tuple[tuple[str, str, Callable[[Task], Deliver]], ...] = (
    ("pybsm", "pyBSM simulate_image", pybsm_simulate_image),
    ("pybsm", "pyBSM SystemOTFSimulator, known", pybsm_cached),
    ("galsim", "GalSim, quintic (its default)", galsim_with("quintic")),
    ("galsim", "GalSim, lanczos15", galsim_with("lanczos15")),
    ("prysm", "prysm", prysm_pupil),
)
