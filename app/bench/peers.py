"""The same work done by other programs, where they are installed, as in their documentation.

A circular aperture and a square pixel blur a frame; its sampling is that of pyBSM's documentation,
a quarter of the cutoff's period. The delivered MTF is the FFT of a unit point sent through the
whole path, and its error the largest difference from the analytic product. Then electrons and SNR
of cameras. Both model photon noise, the optics' emission, dark current, read noise, quantization.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib import import_module, metadata
from importlib.util import find_spec
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.bench.chains import SCENE, SceneStore, sensor_network
from app.bench.tables import T0_HEADS, Chart, Table
from app.bench.timing import Settings, paired, round_trip, seconds
from app.bench.truth import Sensor
from app.run.process import version
from core.chain.engine import Engine
from core.evaluation.policy import Policy, Precision
from core.physics.radiometry.planck import band_radiance
from core.transfer.factors import Planar
from core.transfer.planar_blocks import Axes, Known
from nodes.library import standard_library

Array = NDArray[Any]
Deliver = Callable[[Array], Array]
GONE = "pkg_resources"
RANGE_M = 1000.0
SAMPLES = 2001  # wavelengths of pyBSM's sums


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
        return self.pixel_um / self.focal_length_mm


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
                row |= _delivered(Task(size), build, settings)
            rows.append({**row, "note": missing} if missing else row)
    heads = {"program": "program", "version": "version", "size": "size", **T0_HEADS}
    heads |= {"error": "delivered MTF error", "shift": "shift, samples", "note": ""}
    text = (
        "In every row, T0 is measured on the frame in single precision. `known`: the "
        "transfer function or PSF has been computed already, and only the frame is new. "
        "`mirrored`: the frame is mirrored at its edges, so the tails of the point image come "
        "back into the frame, and the FFT that measures the MTF counts them as error. The extra "
        "`peers` installs the other programs."
    )
    last = ("size", sizes[-1])
    name = f"Aperture and pixel: error of the delivered MTF against time, {sizes[-1]}²"
    chart = Chart("largest error of the delivered MTF", "program", "maker",
                  lines=False, title=name, where=last, by_colour=True)  # fmt: skip
    title = "Filtering a frame: circular aperture and square pixel"
    return [Table("peers", title, heads, rows, text, chart)]


def _delivered(task: Task, build: Callable[[Task], Deliver], settings: Settings) -> dict[str, Any]:
    size = task.size
    scene = np.random.default_rng(3).uniform(20, 60, (size, size)).astype(np.float32)
    t0 = round_trip(scene, Policy().workers)
    try:
        deliver = build(task)
        subject = partial(seconds, partial(deliver, scene))
        timing = paired(subject, t0, pairs=settings.slow_pairs, warm_up=1)
        point = np.zeros((size, size), np.float32)
        point[size // 2, size // 2] = 1
        response = np.fft.fft2(np.asarray(deliver(point), np.float64)) / np.fft.fft2(point)
    except Exception as error:  # another program's failure is a row of the table, not ours
        return {"note": f"failed: {type(error).__name__}: {error}"[:120]}
    frequency = np.fft.fftfreq(size, task.interval_mrad).astype(np.longdouble)
    sensor = Sensor(task.interval_mrad, task.aperture_mm, task.wavelength_um, 0.0, task.pixel_mrad)
    modulus = sensor.modulus(frequency[np.newaxis, :], frequency[:, np.newaxis])
    wrong = float(np.abs(np.abs(response) - np.abs(np.asarray(modulus, np.float64))).max())
    shift = -float(np.angle(response[0, 1])) * size / (2 * np.pi)
    row = {**timing, "error": wrong, "shift": shift}
    return row | {"note": getattr(deliver, "note", "")}


class Chain:
    """The frame through our aperture and pixel; nothing computed before, or the OTF known."""

    def __init__(self, edges: str, precision: Precision, known: bool, task: Task) -> None:
        across = float(np.degrees(task.size * task.interval_mrad * 1e-3))
        init = {"focal_length_mm": task.focal_length_mm, "detector_x_um": task.pixel_um}
        scene = {"kind": "uniform", "width": task.size, "height": task.size}
        self._network = sensor_network(
            ("test_scene", {**scene, "fov_x_deg": across, "fov_y_deg": across}),
            {**init, "detector_y_um": task.pixel_um, "edges": edges},
            {"pixel": ("detector_mtf", {})},
            disc=(task.aperture_mm, task.wavelength_um),
        )
        self._store = SceneStore()
        self._engine = Engine(standard_library(), self._store)
        self._work = self._engine.work(Policy(precision=precision))
        plan = self._engine.plan(self._network)
        self._key = f"{plan.output(SCENE).recipe.key}/{self._work.policy.key}"
        self.note = ""
        if known:
            factor = plan.output("optics.mtf").factors[0]
            assert isinstance(factor, Planar)
            axes: Axes = "mirrored" if edges == "reflect" else "periodic"
            grid = plan.output("init.context").grid
            self.note = self._work.value(Known(factor, grid, axes, node=factor.node)).description
        self._known = self._store.keys()

    def __call__(self, frame: Array) -> Array:
        self._store.forget_all_but(self._known)
        self._store.hold(self._key, frame.astype(self._work.policy.dtype, copy=False))
        plan = self._engine.plan(self._network)
        return np.asarray(self._engine.value(plan, "back.image", self._work))


def _pybsm(task: Task) -> dict[str, Any]:
    simulation = load("pybsm.simulation")
    around, focal_length_m = task.wavelength_um * 1e-6, task.focal_length_mm * 1e-3
    sensor = simulation.Sensor(
        name="sensor", D=task.aperture_mm * 1e-3, f=focal_length_m,
        # As many samples out as in: nothing is resampled.
        p_x=task.interval_mrad * 1e-3 * focal_length_m,
        w_x=task.pixel_um * 1e-6, w_y=task.pixel_um * 1e-6,
        opt_trans_wavelengths=np.array([0.99 * around, 1.01 * around]),
    )  # fmt: skip
    scenario = simulation.Scenario(
        name="scenario", ihaze=1, altitude=RANGE_M, ground_range=0.0, cn2_at_1m=0.0
    )
    return {"sensor": sensor, "scenario": scenario}


def pybsm_simulate_image(task: Task) -> Deliver:
    """The function `simulate_image`; its blurred picture, back on the scale of the frame."""
    simulation, described = load("pybsm.simulation"), _pybsm(task)

    def deliver(frame: Array) -> Array:
        low, high = float(frame.min()), float(frame.max())
        reference = simulation.RefImage(
            img=frame, gsd=task.interval_mrad * 1e-3 * RANGE_M, pix_values=np.array([low, high]),
            refl_values=np.array([0.05, 0.95]),
        )  # fmt: skip
        ideal, blurred, _ = simulation.simulate_image(ref_img=reference, **described)
        scale = (high - low) / (float(ideal.max()) - float(ideal.min()))
        return np.asarray((blurred - float(ideal.min())) * scale + low)

    return deliver


def pybsm_cached(task: Task) -> Deliver:
    """`SystemOTFSimulator`, which keeps its PSF."""
    simulator = load("pybsm.simulation.image_simulator").SystemOTFSimulator(
        **_pybsm(task), mtf_wavelengths=np.array([task.wavelength_um * 1e-6]),
        mtf_weights=np.array([1.0]), do_resample=False,
    )  # fmt: skip
    gsd = task.interval_mrad * 1e-3 * RANGE_M
    return lambda frame: np.asarray(simulator.simulate_image(frame, gsd)[1])


def galsim(interpolant: str, task: Task) -> Deliver:
    program: Any = load("galsim")
    airy = program.Airy(lam_over_diam=task.wavelength_um / task.aperture_mm)
    pixel = program.Pixel(task.pixel_mrad)

    def deliver(frame: Array) -> Array:
        image = program.Image(np.asarray(frame), scale=task.interval_mrad, xmin=0, ymin=0)
        scene = program.InterpolatedImage(image, x_interpolant=interpolant)
        drawn = program.Image(task.size, task.size, scale=task.interval_mrad)
        blurred = program.Convolve([scene, airy, pixel])
        blurred.drawImage(image=drawn, method="no_pixel")
        return np.asarray(drawn.array)

    return deliver


def prysm(task: Task) -> Deliver:
    """A sampled pupil to its PSF and MTF, which multiplies the frame's spectrum."""
    coordinates, geometry, otf, propagation = (
        load(f"prysm.{name}") for name in ("coordinates", "geometry", "otf", "propagation")
    )
    psf_um = task.interval_mrad * task.focal_length_mm
    # As wide an array that the PSF has the frame's interval, and so the MTF its frequencies.
    pitch_mm = task.wavelength_um * task.focal_length_mm / (task.size * psf_um)
    pixel = np.sinc(task.pixel_mrad * np.fft.fftfreq(task.size, task.interval_mrad))

    def deliver(frame: Array) -> Array:
        x, y = coordinates.make_xy_grid(task.size, dx=pitch_mm)
        radius, _ = coordinates.cart_to_polar(x, y)
        pupil = geometry.circle(task.aperture_mm / 2, radius)
        psf = np.abs(propagation.focus(pupil.astype(np.complex128), Q=1)) ** 2
        mtf = np.fft.ifftshift(otf.mtf_from_psf(psf, psf_um).data)
        return np.real(np.fft.ifft2(np.fft.fft2(frame) * mtf * np.outer(pixel, pixel)))

    return deliver


Way = tuple[str, str, Callable[[Task], Deliver]]
OURS: tuple[Way, ...] = (
    ("imagechain", "Imagechain, periodic", partial(Chain, "periodic", "single", False)),
    ("imagechain", "Imagechain, periodic, known", partial(Chain, "periodic", "single", True)),
    ("imagechain", "Imagechain, periodic, double", partial(Chain, "periodic", "double", False)),
    ("imagechain", "Imagechain, mirrored", partial(Chain, "reflect", "single", False)),
    ("imagechain", "Imagechain, mirrored, known", partial(Chain, "reflect", "single", True)),
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


@dataclass(frozen=True)
class Camera:
    """A camera that both programs can describe, and the temperatures of two uniform scenes.

    Of reflected light they are those whose radiance in the band the scenes have, with the spectrum
    of the plane's `source_K`.
    """

    name: str
    band_um: tuple[float, float]
    scenes_K: tuple[float, float]
    pitch_um: float
    focal_length_mm: float
    f_number: float
    plane: dict[str, Any]
    obscuration_ratio: float = 0.0


_COOLED = {
    "integration_time_s": 4e-3, "quantum_efficiency": 0.7, "optics_transmission": 0.765,
    "dark_current_e_per_s": 0.0, "read_noise_e": 400.0, "full_well_e": 7e6, "bits": 14,
}  # fmt: skip
CAMERAS = (
    Camera("cooled, 3.7 to 4.8 µm", (3.7, 4.8), (294.15, 293.15), 15.0, 100.0, 4.0, _COOLED),
    Camera("the same with a mirror lens, obscuration 0.6", (3.7, 4.8), (294.15, 293.15), 15.0,
           100.0, 4.0, _COOLED, 0.6),
    Camera("cooled, 8 to 10 µm, warm optics", (8.0, 10.0), (301.0, 300.0), 20.0, 100.0, 2.0, {
        "integration_time_s": 5e-5, "quantum_efficiency": 0.6, "optics_transmission": 0.8,
        "dark_current_e_per_s": 1e8, "read_noise_e": 800.0, "full_well_e": 3e7, "bits": 14,
        "optics_K": 300.0,
    }),
    Camera("satellite with TDI, obscuration 0.35", (0.5, 0.8), (1288.0, 1270.0), 8.0, 1e4, 14.3, {
        "integration_time_s": 6.94e-5, "quantum_efficiency": 0.6, "optics_transmission": 0.7,
        "dark_current_e_per_s": 1e4, "read_noise_e": 20.0, "full_well_e": 3e4, "bits": 12,
        "tdi_stages": 32, "photon_weighting": "source", "source_K": 5800.0,
    }, 0.35),
)  # fmt: skip


def peer_cameras(_settings: Settings) -> list[Table]:
    missing = why_missing("pybsm")
    rows = []
    for camera in CAMERAS:
        theirs, note = dict.fromkeys(("electrons", "noise", "contrast SNR")), missing
        try:
            theirs = theirs if missing else of_pybsm(camera)
        except Exception as error:  # another program's failure is a row of the table, not ours
            note = f"failed: {type(error).__name__}: {error}"[:120]
        for figure, own in of_ours(camera).items():
            other, unit = theirs[figure], "" if "SNR" in figure else "e-"
            row = {"camera": camera.name, "figure": figure, "unit": unit, "ours": own}
            percent = None if other is None else 100.0 * (own / other - 1.0)
            rows.append({**row, "pybsm": other, "percent": percent, "note": note})
    release = "" if missing else metadata.version("pybsm")
    heads = {"camera": "camera", "figure": "figure", "ours": "imagechain"}
    heads |= {"pybsm": f"pyBSM {release}".strip(), "unit": "", "percent": "difference, %"}
    text = (
        "Uniform scenes. The contrast SNR is the difference in electrons between two scenes, "
        "divided by the noise of the brighter one. pyBSM's converter has 2^bits steps, ours "
        f"one fewer; pyBSM sums over {SAMPLES} wavelengths."
    )
    title = "From photons to electrons: noise and SNR of cameras, compared with pyBSM"
    return [Table("peer_cameras", title, {**heads, "note": ""}, rows, text)]


def of_ours(camera: Camera) -> dict[str, float]:
    low, high = camera.band_um
    band = {"cut_on_um": low, "cut_off_um": high, "fov_x_deg": 1.0, "fov_y_deg": 1.0}
    sensor = {
        "detector_x_um": camera.pitch_um, "detector_y_um": camera.pitch_um,
        "focal_length_mm": camera.focal_length_mm, "f_number": camera.f_number,
        "obscuration_ratio": camera.obscuration_ratio, "platform": "array",
    }  # fmt: skip
    engine = Engine(standard_library())
    found = []
    for kelvin in camera.scenes_K:
        scene = {"kind": "uniform", "width": 4, "height": 4, "temperature_K": kelvin, **band}
        plane = {"camera": ("focal_plane", camera.plane)}
        plan = engine.plan(sensor_network(("test_scene", scene), sensor, {}, plane))
        found.append(engine.readouts(plan, "camera", engine.work(Policy("double"))))
    bright, dim = (float(one["signal_e"]) for one in found)
    noise = float(found[0]["temporal_noise_e"])
    return {"electrons": bright, "noise": noise, "contrast SNR": (bright - dim) / noise}


def of_pybsm(camera: Camera) -> dict[str, Any]:
    """The same by the function `photon_detector_SNR`."""
    simulation, radiance = load("pybsm.simulation"), load("pybsm.radiance")
    wavelengths = np.linspace(*camera.band_um, SAMPLES) * 1e-6
    ends = np.array([0.99 * wavelengths[0], 1.01 * wavelengths[-1]])
    plane = camera.plane
    warm_K, source_K = plane.get("optics_K"), plane.get("source_K")
    sensor = simulation.Sensor(
        name=camera.name, D=camera.focal_length_mm / camera.f_number * 1e-3,
        f=camera.focal_length_mm * 1e-3, p_x=camera.pitch_um * 1e-6, opt_trans_wavelengths=ends,
        qe_wavelengths=ends, qe=np.full(2, plane["quantum_efficiency"]),
        int_time=plane["integration_time_s"], n_tdi=float(plane.get("tdi_stages", 1)),
        dark_current=plane["dark_current_e_per_s"], read_noise=plane["read_noise_e"],
        max_n=plane["full_well_e"], max_well_fill=1.0, bit_depth=float(plane["bits"]),
        optics_temperature=warm_K or 70.0,
        optics_emissivity=1.0 - plane["optics_transmission"] if warm_K else 0.0,
    )  # fmt: skip
    sensor.eta = camera.obscuration_ratio
    sensor.optics_transmission = np.full(2, plane["optics_transmission"])

    def spectral(kelvin: float) -> Any:
        shape = radiance.blackbody_radiance(lambda0=wavelengths, T=source_K or kelvin)
        if source_K is None:
            return shape
        low, high = camera.band_um
        wanted, source = (
            float(band_radiance(temperature_K=one, cut_on_um=low, cut_off_um=high))
            for one in (kelvin, source_K)
        )
        return shape * wanted / source

    target, background = map(spectral, camera.scenes_K)
    found = radiance.photon_detector_SNR(
        sensor=sensor, radiance_wavelengths=wavelengths,
        target_radiance=target, background_radiance=background,
    )  # fmt: skip
    others = float(found.self_emission_noise) ** 2 + float(found.dark_current_noise) ** 2
    electrons, noise = float(found.tgt_n) - others, float(found.total_noise)
    return {"electrons": electrons, "noise": noise, "contrast SNR": float(found.snr)}


MEASURES = (peers, peer_cameras)
