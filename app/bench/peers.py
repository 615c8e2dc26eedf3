"""The same work done by other programs, where they are installed, as in their documentation.

A circular aperture and a square pixel blur a frame; the delivered MTF is the FFT of a unit point
sent through the whole path, and its error the largest difference from the analytic product.
"""

import sys
import warnings
from collections.abc import Callable
from functools import partial
from importlib import import_module, metadata
from importlib.util import find_spec
from types import ModuleType
from typing import Any

import numpy as np

from app.bench.tables import T0_HEADS, Chart, Table
from app.bench.timing import Chain, Settings, paired, round_trip, seconds, sensor_network
from app.bench.truth import Sensor
from app.run.terminal import version
from core.arrays import Array
from core.evaluation.work import Policy, Precision
from core.transfer.factors import Edges, Planar
from core.transfer.planar_blocks import Known, RadialTable

Deliver = Callable[[Array], Array]
GONE = "pkg_resources"
RANGE_M = 1000.0

_KEPT = {
    tuple: "stored at low rank",
    np.ndarray: "stored as a whole plane",
    RadialTable: "stored as a radial table",
    type(None): "evaluated each time",
}


# A circular aperture and a square pixel before a square frame.
APERTURE_MM, WAVELENGTH_UM = 90.0, 4.0
FOCAL_LENGTH_MM, PIXEL_UM = 200.0, 20.0
INTERVAL_MRAD = WAVELENGTH_UM / (4 * APERTURE_MM)  # a quarter of the cutoff's period
PIXEL_MRAD = PIXEL_UM / FOCAL_LENGTH_MM


def peers(settings: Settings) -> list[Table]:
    sizes = (settings.size // 2,) if settings.quick else (settings.size // 2, settings.size)
    rows: list[dict[str, Any]] = []
    for size in sizes:
        for maker, name, build in (*OURS, *PEERS):
            row: dict[str, Any] = {"program": name, "size": size}
            missing = "" if maker == "imagechain" else why_missing(maker)
            if not missing:
                release = version() if maker == "imagechain" else metadata.version(maker)
                row |= {"maker": maker, "version": release}
                row |= _delivered(size, build, settings)
            rows.append({**row, "note": missing} if missing else row)
    heads = {"program": "program", "version": "version", "size": "size", **T0_HEADS}
    heads |= {"error": "delivered MTF error", "shift": "shift, samples", "note": ""}
    text = (
        "In every row, T0 is measured on the frame in single precision. `known`: the transfer "
        "function or PSF has been computed already, and only the frame is new. `mirrored`: the "
        "frame is mirrored at its edges. The tails of the point spread function wrap around "
        "into the frame and add to the MTF error. Install the other "
        "programs with the extra `peers`."
    )
    last = ("size", sizes[-1])
    name = f"Aperture and pixel: error of the delivered MTF against time, {sizes[-1]}²"
    chart = Chart("largest error of the delivered MTF", "program", "maker",
                  lines=False, title=name, where=last, by_colour=True)  # fmt: skip
    title = "Filtering a frame: circular aperture and square pixel"
    return [Table("peers", title, heads, rows, text, chart)]


def _delivered(size: int, build: Callable[[int], Deliver], settings: Settings) -> dict[str, Any]:
    scene = np.random.default_rng(3).uniform(20, 60, (size, size)).astype(np.float32)
    t0 = round_trip(scene, Policy().workers)
    try:
        deliver = build(size)
        subject = partial(seconds, partial(deliver, scene))
        timing = paired(subject, t0, pairs=settings.slow_pairs, warm_up=1)
        point = np.zeros((size, size), np.float32)
        point[size // 2, size // 2] = 1
        response = np.fft.fft2(np.asarray(deliver(point), np.float64)) / np.fft.fft2(point)
    except Exception as error:  # another program's failure is a row of the table, not ours
        return {"note": f"failed: {type(error).__name__}: {error}"[:120]}
    frequency = np.fft.fftfreq(size, INTERVAL_MRAD).astype(np.longdouble)
    sensor = Sensor(INTERVAL_MRAD, APERTURE_MM, WAVELENGTH_UM, 0.0, PIXEL_MRAD)
    modulus = sensor.modulus(frequency[np.newaxis, :], frequency[:, np.newaxis])
    wrong = float(np.abs(np.abs(response) - np.abs(np.asarray(modulus, np.float64))).max())
    shift = -float(np.angle(response[0, 1])) * size / (2 * np.pi)
    row = {**timing, "error": wrong, "shift": shift}
    return row | {"note": getattr(deliver, "note", "")}


class Ours(Chain):
    """The frame through our aperture and pixel; nothing computed before, or the OTF known."""

    def __init__(self, edges: Edges, precision: Precision, known: bool, size: int) -> None:
        across = float(np.degrees(size * INTERVAL_MRAD * 1e-3))
        init = {"focal_length_mm": FOCAL_LENGTH_MM, "detector_x_um": PIXEL_UM}
        scene = {"kind": "uniform", "width": size, "height": size}
        network = sensor_network(
            ("test_scene", {**scene, "fov_x_deg": across, "fov_y_deg": across}),
            {**init, "detector_y_um": PIXEL_UM, "edges": edges},
            {"pixel": ("detector_mtf", {})},
            disc=(APERTURE_MM, WAVELENGTH_UM),
        )
        super().__init__(network, Policy(precision=precision))
        self.note = ""
        if known:
            plan = self.engine.plan(network)
            factor = plan.output("optics.mtf").factors[0]
            assert isinstance(factor, Planar)
            grid = plan.output("init.context").grid
            kept = self.work.value(Known(factor, grid, edges, node=factor.node))
            self.note = _KEPT[type(kept)]
        self._known = self.store.keys()

    def __call__(self, frame: Array) -> Array:
        self.store.forget_all_but(self._known)
        self.take(frame.astype(self.policy.dtype, copy=False))
        return np.asarray(self.value(self.network, "back.image"))


def _pybsm() -> dict[str, Any]:
    simulation = load("pybsm.simulation")
    around, focal_length_m = WAVELENGTH_UM * 1e-6, FOCAL_LENGTH_MM * 1e-3
    sensor = simulation.Sensor(
        name="sensor", D=APERTURE_MM * 1e-3, f=focal_length_m,
        # As many samples out as in: nothing is resampled.
        p_x=INTERVAL_MRAD * 1e-3 * focal_length_m,
        w_x=PIXEL_UM * 1e-6, w_y=PIXEL_UM * 1e-6,
        opt_trans_wavelengths=np.array([0.99 * around, 1.01 * around]),
    )  # fmt: skip
    scenario = simulation.Scenario(
        name="scenario", ihaze=1, altitude=RANGE_M, ground_range=0.0, cn2_at_1m=0.0
    )
    return {"sensor": sensor, "scenario": scenario}


def pybsm_simulate_image(_size: int) -> Deliver:
    """The function `simulate_image`; its blurred picture, back on the scale of the frame."""
    simulation, described = load("pybsm.simulation"), _pybsm()

    def deliver(frame: Array) -> Array:
        low, high = float(frame.min()), float(frame.max())
        reference = simulation.RefImage(
            img=frame, gsd=INTERVAL_MRAD * 1e-3 * RANGE_M, pix_values=np.array([low, high]),
            refl_values=np.array([0.05, 0.95]),
        )  # fmt: skip
        ideal, blurred, _ = simulation.simulate_image(ref_img=reference, **described)
        scale = (high - low) / (float(ideal.max()) - float(ideal.min()))
        return np.asarray((blurred - float(ideal.min())) * scale + low)

    return deliver


def pybsm_cached(_size: int) -> Deliver:
    """`SystemOTFSimulator`, which keeps its PSF."""
    simulator = load("pybsm.simulation.image_simulator").SystemOTFSimulator(
        **_pybsm(), mtf_wavelengths=np.array([WAVELENGTH_UM * 1e-6]),
        mtf_weights=np.array([1.0]), do_resample=False,
    )  # fmt: skip
    gsd = INTERVAL_MRAD * 1e-3 * RANGE_M
    return lambda frame: np.asarray(simulator.simulate_image(frame, gsd)[1])


def galsim(interpolant: str, size: int) -> Deliver:
    program: Any = load("galsim")
    airy = program.Airy(lam_over_diam=WAVELENGTH_UM / APERTURE_MM)
    pixel = program.Pixel(PIXEL_MRAD)

    def deliver(frame: Array) -> Array:
        image = program.Image(np.asarray(frame), scale=INTERVAL_MRAD, xmin=0, ymin=0)
        scene = program.InterpolatedImage(image, x_interpolant=interpolant)
        drawn = program.Image(size, size, scale=INTERVAL_MRAD)
        blurred = program.Convolve([scene, airy, pixel])
        blurred.drawImage(image=drawn, method="no_pixel")
        return np.asarray(drawn.array)

    return deliver


def prysm(size: int) -> Deliver:
    """A sampled pupil to its PSF and MTF, which multiplies the frame's spectrum."""
    coordinates, geometry, otf, propagation = (
        load(f"prysm.{name}") for name in ("coordinates", "geometry", "otf", "propagation")
    )
    psf_um = INTERVAL_MRAD * FOCAL_LENGTH_MM
    # As wide an array that the PSF has the frame's interval, and so the MTF its frequencies.
    pitch_mm = WAVELENGTH_UM * FOCAL_LENGTH_MM / (size * psf_um)
    pixel = np.sinc(PIXEL_MRAD * np.fft.fftfreq(size, INTERVAL_MRAD))

    def deliver(frame: Array) -> Array:
        x, y = coordinates.make_xy_grid(size, dx=pitch_mm)
        radius, _ = coordinates.cart_to_polar(x, y)
        pupil = geometry.circle(APERTURE_MM / 2, radius)
        psf = np.abs(propagation.focus(pupil.astype(np.complex128), Q=1)) ** 2
        mtf = np.fft.ifftshift(otf.mtf_from_psf(psf, psf_um).data)
        return np.real(np.fft.ifft2(np.fft.fft2(frame) * mtf * np.outer(pixel, pixel)))

    return deliver


Way = tuple[str, str, Callable[[int], Deliver]]
OURS: tuple[Way, ...] = (
    ("imagechain", "Imagechain, periodic", partial(Ours, "periodic", "single", False)),
    ("imagechain", "Imagechain, periodic, known", partial(Ours, "periodic", "single", True)),
    ("imagechain", "Imagechain, periodic, double", partial(Ours, "periodic", "double", False)),
    ("imagechain", "Imagechain, mirrored", partial(Ours, "reflect", "single", False)),
    ("imagechain", "Imagechain, mirrored, known", partial(Ours, "reflect", "single", True)),
)
PEERS: tuple[Way, ...] = (
    ("pybsm", "pyBSM simulate_image", pybsm_simulate_image),
    ("pybsm", "pyBSM SystemOTFSimulator, known", pybsm_cached),
    ("galsim", "GalSim, quintic (its default)", partial(galsim, "quintic")),
    ("galsim", "GalSim, lanczos15", partial(galsim, "lanczos15")),
    ("prysm", "prysm", prysm),
)


def load(name: str) -> Any:
    """A module of another program; its warnings are none of ours.

    prysm 0.21 takes its version, and nothing else, from pkg_resources, which the setuptools that
    pyBSM requires do not have: something stands in for it.
    """
    lacking = GONE not in sys.modules and find_spec(GONE) is None
    if lacking:
        sys.modules[GONE] = ModuleType(GONE)
        sys.modules[GONE].get_distribution = metadata.distribution  # type: ignore[attr-defined]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return import_module(name)
    finally:
        if lacking:
            del sys.modules[GONE]


def why_missing(package: str) -> str:
    """Why a program cannot be measured; empty if it can."""
    try:
        load(package)
    except ImportError as error:
        return "not installed" if error.name == package else f"not importable: {error}"[:120]
    return ""


MEASURES = (peers,)
