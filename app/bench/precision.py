"""Time in T0 against error, for every choice of a user that trades one for the other."""

import math
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from app.bench import timing, truth
from app.bench.tables import T0_HEADS, Chart, Table, figure_text
from core.arrays import Array
from core.chain.back_transformed import Delivered
from core.chain.random_fields import Stream, normal_field, poisson_field
from core.evaluation.work import Policy, Precision
from core.machine import ForEach
from core.network.network import Network
from core.physics.detector.detector_mtf import MODELS, charge_transfer_mtf, charge_transfer_ptf
from core.transfer.factors import Grid, Planar, Product
from core.transfer.planar_blocks import Planes

Row = dict[str, Any]
PRECISIONS: tuple[Precision, ...] = ("single", "double")
ARRAY_MM, RADIUS_MM, WAVELENGTH_UM = 128.0, 45.0, 4.0
POINTS = 24  # of a pupil's OTF that are held against the truth
ROWS_AT_ONCE = 64
TRANSFERS = ((640, "0.99999"), (640, "0.999"), (2048, "0.995"))
MEANS = (0.0034, 0.3, 3.0, 30.0, 300.0, 3000.0)  # the two first: the thesis' sensors
CHANCE = 1.36  # 95 of 100 samples of n stay within 1.36/√n of their law (Kolmogorov)
INTERVAL_MRAD = math.radians(25.0) * 1000.0 / 1024  # the shipped Kodak's, whatever the size
# Two stages a decade: those up to a decade together stay within its tolerance.
STRENGTHS = tuple(0.4 * 10.0**decade for decade in range(-9, -1) for _ in range(2))
TOLERANCES = (0.0, None, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2)


def precision(settings: timing.Settings) -> list[Table]:
    single = timing.kodak_chain(settings.small)
    scene = single.scene
    expected = truth.mirrored_picture(scene, truth.Sensor(_grid(single).interval_x_mrad))
    rows = []
    for kind in PRECISIONS:
        # The same samples for both, so that drawing in another precision is no error.
        kodak = timing.kodak_chain(settings.small, kind, scene)
        quiet = timing.without_photons(kodak.network)
        mean = float(kodak.value(quiet, timing.PIXELS).mean(dtype=np.float64))
        wrong = abs(mean / float(expected.mean()) - 1)
        row = _of_picture(kodak, quiet, expected, scene, settings)
        rows.append({"choice": kind, **row, "mean_error": wrong})
    heads = {"choice": "precision", **T0_HEADS, "error": "error / max"}
    heads["mean_error"] = "relative error of the picture's mean"
    text = (
        "Single precision is the default: its error is far below the noise and the step of any "
        "practical quantizer, and it takes half the memory of double precision. T0 is measured in "
        "single precision in both rows."
    )
    title = f"Precision: Kodak optics, {settings.small}², mirrored, compared with a direct sum"
    return [Table("precision", title, heads, rows, text, Chart("largest error", "choice"))]


def edges(settings: timing.Settings) -> list[Table]:
    kodak = timing.kodak_chain(settings.small)
    scene, sensor = kodak.scene, truth.Sensor(_grid(kodak).interval_x_mrad)
    mirrored = truth.mirrored_picture(scene, sensor)
    rows = []
    for choice in ("reflect", "periodic"):
        expected = mirrored if choice == "reflect" else truth.periodic_picture(scene, sensor)
        network = timing.without_photons(kodak.network).with_parameter("init", "edges", choice)
        other = np.abs(expected - mirrored) / np.abs(mirrored).max()
        border = min(8, len(other) // 4)
        inside = float(other[border:-border, border:-border].max())
        row = _of_picture(kodak, network, expected, scene, settings)
        rows.append({"choice": choice, **row, "border": float(other.max()), "inside": inside})
    heads = {"choice": "edges", **T0_HEADS, "error": "error / max"}
    heads |= {
        "border": "largest difference from reflect",
        "inside": "largest difference, more than 8 samples from the edge",
    }
    text = (
        "Reflect is the default: nothing wraps around from the opposite side of the picture, and "
        "the frame needs no padding. The columns on the right show what a periodic frame would "
        "change."
    )
    title = f"Edges: Kodak optics, {settings.small}², single precision, compared with direct sums"
    return [Table("edges", title, heads, rows, text, Chart("largest error", "choice"))]


def _of_picture(
    kodak: timing.Chain, network: Network, expected: Array, scene: Array, settings: timing.Settings
) -> Row:
    t0 = timing.round_trip(scene, kodak.policy.workers)
    took = timing.paired(partial(kodak.cold, network, timing.PIXELS), t0, pairs=settings.pairs)
    wrong = np.abs(kodak.value(network, timing.PIXELS) - expected).max() / np.abs(expected).max()
    return {**took, "error": float(wrong)}


def _otf(kodak: timing.Chain, network: Network) -> tuple[Planar, Grid]:
    factor = kodak.engine.plan(network).output("optics.mtf").factors[0]
    assert isinstance(factor, Planar)
    return factor, _grid(kodak, network)


def _of_blocks(kodak: timing.Chain, grid: Grid, block: Callable[[slice], Any]) -> float:
    """Seconds of all blocks of rows, with an empty store."""
    kodak.store.clear()
    slices = [slice(top, top + ROWS_AT_ONCE) for top in range(0, grid.rows, ROWS_AT_ONCE)]
    start = time.perf_counter()
    kodak.work.for_each(block, slices)
    return time.perf_counter() - start


def _direct(kodak: timing.Chain, factor: Planar, grid: Grid) -> float:
    """Seconds of evaluating an OTF at every frequency, with nothing computed before."""
    xi, eta = grid.axes("reflect")
    across, along = xi[np.newaxis, :], eta[:, np.newaxis]
    return _of_blocks(kodak, grid, lambda at: factor.transfer(kodak.work, across, along[at]))


def _plane(kodak: timing.Chain, factor: Planar, grid: Grid) -> float:
    """Seconds of an OTF's plane as a picture's filter takes it."""
    return _of_blocks(kodak, grid, Planes(kodak.work, Product([factor]), grid, "reflect").block)


def _pupil_error(kodak: timing.Chain, factor: Planar, grid: Grid, shape: str) -> float:
    (rows, columns), (xi, eta) = places_of(grid.rows), grid.axes("reflect")
    lags = WAVELENGTH_UM * xi[columns], WAVELENGTH_UM * eta[rows]
    found = factor.transfer(kodak.work, *(lag / WAVELENGTH_UM for lag in lags))
    half_moon, pairs = shape == "half_moon", zip(*map(np.ndarray.tolist, lags), strict=True)
    expected = [truth.pupil_otf(RADIUS_MM, *pair, half_moon=half_moon) for pair in pairs]
    return float(np.abs(found - np.array(expected)).max())


def places_of(size: int) -> tuple[Array, Array]:
    """Rows and columns of the grid: along both axes, near the cusp at zero, and in between."""
    rows, columns = np.random.default_rng(7).integers(0, size, (2, POINTS))
    rows[: POINTS // 4] = 0
    columns[POINTS // 4 : POINTS // 2] = 0
    near = [math.floor(x) for x in np.geomspace(1, size - 1, POINTS // 4)]
    columns[: POINTS // 4], rows[POINTS // 4 : POINTS // 2] = near, near
    return rows, columns


def pupil_network(network: Network, shape: str, size: int, sampled: str = "") -> Network:
    """The pupil of that shape at `size` samples; autocorrelated with an interpolation if given."""
    radius = RADIUS_MM / ARRAY_MM * size
    for name, value in {"shape": shape, "size_x": size, "size_y": size, "radius": radius}.items():
        network = network.with_parameter("pupil", name, value)
    if sampled:
        network = network.with_parameter("optics", "method", "autocorrelation")
        network = network.with_parameter("optics", "interpolation", sampled)
    return network


def pupil_sampling(settings: timing.Settings) -> list[Table]:
    kodak = timing.kodak_chain(settings.small)
    rows = []
    kinds = ("clear", "bilinear"), ("half_moon", "bilinear"), ("half_moon", "linear")
    for shape, how in kinds:
        for size in (0, *_sizes(settings)) if how == "bilinear" else _sizes(settings):
            network = pupil_network(kodak.network, shape, size or 512, how if size else "")
            otf, method = _otf(kodak, network), how if size else "exact"
            row = {"shape": shape, "method": method, "choice": f"{size}²" if size else "exact"}
            direct = partial(_direct, kodak, *otf)
            took = timing.paired(direct, kodak.t0, pairs=settings.slow_pairs, warm_up=1)
            error = _pupil_error(kodak, *otf, shape)
            rows.append({**row, "curve": f"{shape}, {method}", **took, "error": error})
    heads = {"shape": "pupil", "method": "method", "choice": "OTF", **T0_HEADS}
    heads["error"] = "largest error"
    text = (
        "Exact is the default: a sampled pupil never reaches the small error of the closed form, "
        "however long it takes. Pupils from files and pupils with a wavefront error have no "
        "closed form and are sampled, by default at 512². Bilinear is the default interpolation: "
        "it weights the four neighbouring lags the same way in every direction. Linear over three "
        "lags has a smaller error with coarse samples, because its facets follow the cusp at zero "
        "lag. `none` only shows the raw autocorrelation; it does not filter the picture."
    )
    title = f"Pupil: closed form and autocorrelated samples, {settings.small}² frequencies"
    chart = Chart("largest error", "choice", "curve")
    return [Table("pupil_sampling", title, heads, rows, text, chart)]


def _sizes(settings: timing.Settings) -> tuple[int, ...]:
    return (64, 128, 256) if settings.quick else (64, 128, 256, 512, 1024)


def wavelengths(settings: timing.Settings) -> list[Table]:
    mp = truth.mpmath()
    title = f"Wavelengths for the band 3 to 5 µm, {settings.small}² frequencies"
    heads = {"aperture": "aperture", "choice": "wavelengths", **T0_HEADS, "error": "largest error"}
    if mp is None:
        return [Table("wavelengths", title, heads, [], truth.NEEDS_MPMATH)]
    kodak = timing.kodak_chain(settings.small)
    nyquist = _grid(kodak).nyquist_x
    xi = np.linspace(0.0, nyquist, 17)
    sample_mm = ARRAY_MM / 512
    # A radius in samples whose cutoff at the band's middle is half the Nyquist frequency.
    small = max(0.5 * nyquist * WAVELENGTH_UM / (2 * sample_mm), 0.5)
    rows = []
    for aperture, radius in {
        "Kodak's": RADIUS_MM / sample_mm,
        "small, cutoff at half Nyquist": small,
    }.items():
        means = [truth.disc_band_mean(mp, float(f), 2 * radius * sample_mm, (3, 5)) for f in xi]
        for count in (1, 3, 9, 33) if settings.quick else (1, 2, 3, 5, 9, 17, 33, 129):
            network = kodak.network.with_parameter("pupil", "radius", radius)
            otf = _otf(kodak, network.with_parameter("optics", "wavelengths", count))
            computed = otf[0].transfer(kodak.work, xi, np.zeros_like(xi))
            took = timing.paired(partial(_plane, kodak, *otf), kodak.t0, pairs=3, warm_up=1)
            error = float(np.abs(computed - np.array(means)).max())
            rows.append({"aperture": aperture, "choice": count, **took, "error": error})
    text = (
        "By default, only the band's middle wavelength is used: over the picture's frequencies, "
        "the OTF of an aperture such as Kodak's is almost linear in λ. Use more wavelengths if the "
        "cutoff falls among these frequencies, as for the small aperture. The reference value is "
        "an adaptive integral over the band."
    )
    chart = Chart("largest error", "choice", "aperture")
    return [Table("wavelengths", title, heads, rows, text, chart)]


def charge_transfer(settings: timing.Settings) -> list[Table]:
    title = "Charge transfer: H = MTF·exp(i·PTF) compared with the product of all transfers"
    heads = {"choice": "model", "setting": "N(1 − ε)", "t0": "T0", "mtf": "error of MTF"}
    heads |= {"ptf": "error of PTF, rad", "error": "error of H"}
    mp = truth.mpmath()
    if mp is None:
        return [Table("charge_transfer", title, heads, [], truth.NEEDS_MPMATH)]
    kodak = timing.kodak_chain(settings.small)
    w, full = np.linspace(0.0, math.pi, 65), np.linspace(0.0, math.pi, settings.small)
    rows = []
    for transfers, efficiency in TRANSFERS:
        every = [truth.charge_transfer(mp, x, transfers, efficiency) for x in w]
        mtf, ptf = np.array(every).T
        for model in MODELS:
            how: Any = {"transfers": transfers, "efficiency": float(efficiency), "model": model}
            found, turned = _charge_transfer(w, how)
            subject = partial(timing.seconds, partial(_charge_transfer, full, how))
            took = timing.paired(subject, kodak.t0, pairs=settings.pairs)
            wrong = np.abs(found * np.exp(1j * turned) - mtf * np.exp(1j * ptf))
            setting = f"{transfers} × {figure_text(1 - float(efficiency))}"
            row: Row = {"choice": model, "setting": setting}
            errors = {"mtf": np.abs(found - mtf), "ptf": np.abs(turned - ptf), "error": wrong}
            row |= {name: float(values.max()) for name, values in errors.items()}
            rows.append(row | took)
    text = (
        "Exact is the default: its transfer function along one axis takes almost no time compared "
        "with filtering the picture. The published phase follows a different formula, whose series "
        "starts with w³ instead of w (w: phase per transfer)."
    )
    name = "Charge transfer compared with the product of all transfers, by N × (1 − ε)"
    chart = Chart("largest error of H", "setting", "choice", lines=False, title=name)
    return [Table("charge_transfer", title, heads, rows, text, chart)]


def _charge_transfer(w: Array, how: Any) -> tuple[Any, Any]:
    mtf = charge_transfer_mtf(phase_per_transfer=w, **how)
    return mtf, charge_transfer_ptf(phase_per_transfer=w, **how)


def poisson(settings: timing.Settings) -> list[Table]:
    kodak = timing.kodak_chain(settings.size)
    shape, workers, for_each = kodak.scene.shape, kodak.policy.workers, kodak.work.for_each
    chance = CHANCE / math.sqrt(kodak.scene.size)
    stream = Stream(seed=1996, node="photons", field="photons")
    rows = []
    for mean in MEANS:
        means = np.full(shape, mean, kodak.policy.dtype)
        subjects: dict[str, Callable[[], Any]] = {
            "exact": partial(poisson_field, means, stream, for_each=for_each),
            "exact, numpy": partial(np.random.default_rng(1996).poisson, means),
            "rounded normal": partial(_rounded_normal, means, stream, for_each),
        }
        for choice, subject in subjects.items():
            counts = np.asarray(subject())
            took = timing.paired(
                partial(timing.seconds, subject), kodak.t0, pairs=settings.slow_pairs, warm_up=1
            )
            plain = choice == "exact, numpy"
            row = {"choice": choice, "mean": mean, "mark": None if plain else f"{mean:g}"}
            row |= {"threads": 1 if plain else workers, "chance": chance, **took}
            row |= {"error": truth.kolmogorov_distance(counts, mean)}
            rows.append(row | {"variance": float(counts.var(dtype=np.float64)) / mean - 1.0})
    heads = {"choice": "deviates", "mean": "mean", "threads": "threads", **T0_HEADS}
    heads |= {"error": "Kolmogorov distance", "chance": "by chance"}
    heads["variance"] = "variance / mean − 1"
    text = (
        "Exact deviates are the default, for every mean up to 1e12. Normal deviates, rounded to "
        "counts, are least accurate where photons are few. Exact deviates are also faster there, "
        "because only the photons that arrive are drawn. Above a few photons per sample, normal "
        "deviates are faster, and their distance from Poisson falls as 1/√mean. The distance is "
        "the largest difference between the cumulative distribution of the deviates and Poisson's. "
        f"In 95 of 100 fields of {settings.size}² exact deviates, the distance is below "
        f"{chance:.1g}."
    )
    title = f"Exact and normal deviates for Poisson noise: {settings.size}² samples"
    name = f"{title}, against the mean; distances below {chance:.1g} occur by chance"
    chart = Chart("Kolmogorov distance from Poisson", "mark", "choice", title=name)
    return [Table("poisson", title, heads, rows, text, chart)]


def _rounded_normal(means: Array, stream: Stream, for_each: ForEach) -> Array:
    """The approximation: a normal deviate of the same mean and variance, to the nearest count."""
    counts = normal_field(stream, means.shape, dtype=means.dtype, for_each=for_each)
    counts *= np.sqrt(means)
    counts += means
    np.rint(counts, out=counts)
    return np.maximum(counts, 0, out=counts)


def skipping(settings: timing.Settings) -> list[Table]:
    network, sensor = weak_chain(settings.small)
    first = timing.Chain(network, Policy(tolerance=0.0))
    expected = truth.mirrored_frame(first.scene, sensor)
    rows = []
    for kind in PRECISIONS:
        for tolerance in TOLERANCES:
            chain = timing.Chain(network, Policy(kind, tolerance), first.scene)
            took = timing.paired(
                partial(chain.cold, network, "back.image"), first.t0, pairs=settings.pairs
            )
            error, skipped = left_out(chain, expected)
            shown = "default" if tolerance is None else figure_text(tolerance)
            row = {"precision": kind, "tolerance": chain.policy.budget, "skipped": skipped}
            rows.append({**row, "mark": f"{shown} ({skipped})", **took, "error": error})
    heads = {"precision": "precision", "tolerance": "tolerance", **T0_HEADS}
    heads |= {
        "skipped": f"stages left out (of {len(STRENGTHS)})",
        "error": "rms error / (max − min)",
    }
    text = (
        "The default tolerance is one eighth of the samples' rounding error, so the effect of "
        "leaving stages out cannot be distinguished from rounding. With a larger tolerance, the "
        "run is faster, and the error still stays below the tolerance. T0 is measured in single "
        "precision in all rows."
    )
    title = f"Leaving out weak stages: {len(STRENGTHS)} stages, {settings.small}², mirrored"
    name = f"{title}: tolerance (stages left out)"
    chart = Chart("rms error / (max − min)", "mark", "precision", title=name)
    return [Table("skipping", title, heads, rows, text, chart)]


def left_out(chain: timing.Chain, expected: Array) -> tuple[float, int]:
    """Rms error over the range, and how many stages were left out."""
    recipe = chain.engine.plan(chain.network).output("back.image").recipe
    assert isinstance(recipe, Delivered)
    wrong = np.asarray(chain.value(chain.network, "back.image"), np.float64) - expected
    rms = float(np.sqrt(np.mean(wrong * wrong)) / (expected.max() - expected.min()))
    return rms, len(recipe.spent(chain.work)[1])


def weak_chain(size: int) -> tuple[Network, truth.Sensor]:
    """Pupil, aberration and pixel with blurs ever weaker, and the same for the truth."""
    corner = math.sqrt(0.5) / INTERVAL_MRAD
    sigmas = tuple(math.sqrt(0.5 * strength) / (math.pi * corner) for strength in STRENGTHS)
    sensor = truth.Sensor(INTERVAL_MRAD, pixel_mrad=0.125, transfers=0, blurs_mrad=sigmas)
    field_deg = math.degrees(INTERVAL_MRAD * 1e-3 * size)
    scene = {"kind": "dormitory", "width": size, "height": size}
    scene |= {"fov_x_deg": field_deg, "fov_y_deg": field_deg}
    init = {"focal_length_mm": 1e3, "detector_x_um": 125.0, "detector_y_um": 125.0}
    stages: dict[str, tuple[str, dict[str, Any]]] = {"pixel": ("detector_mtf", {})}
    for number, sigma in enumerate((sensor.aberration_mrad, *sigmas)):
        blur = {"sigma_x_mrad": sigma, "sigma_y_mrad": sigma}
        stages[f"blur_{number}"] = ("gaussian_mtf", blur)
    disc = (sensor.aperture_mm, sensor.wavelength_um)
    return timing.sensor_network(("test_scene", scene), init, stages, disc=disc), sensor


def _grid(kodak: timing.Chain, network: Network | None = None) -> Grid:
    grid = kodak.engine.plan(network or kodak.network).output("init.context").grid
    assert isinstance(grid, Grid)
    return grid


MEASURES = (
    precision, edges, pupil_sampling, wavelengths, charge_transfer, poisson, skipping,
)  # fmt: skip
