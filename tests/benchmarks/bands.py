"""A cube through optics: time against error of few wavelengths, of all, and of one band."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from app.bench.chains import SceneStore
from app.bench.tables import Chart, Table, verdict
from app.bench.timing import Settings, paired, round_trip
from core.chain.back_transformed import Delivered
from core.chain.engine import Engine
from core.chain.filtered_sum import WavelengthRank
from core.evaluation.policy import Policy
from core.evaluation.recipes import Recipe
from core.network.network import Link, Network, Node
from core.physics.radiometry.planck import spectral_radiance
from core.transfer.planar_blocks import Precomputed
from nodes.library import standard_library

Array = NDArray[Any]
LOW_UM, HIGH_UM = 3.0, 5.0
APERTURE_MM, INTERVAL_MRAD = 100.0, 0.035
_KELVIN = (280.0, 300.0, 310.0, 290.0, 320.0)
_BLOCK = 8  # samples along a side of a patch of one material


def wavelengths_um(bands: int) -> NDArray[np.float64]:
    """Middles of bands that fill 3 to 5 µm."""
    return LOW_UM + (HIGH_UM - LOW_UM) * (np.arange(bands) + 0.5) / bands


def write_cube(folder: Path, size: int, bands: int) -> NDArray[np.float32]:
    """Write ``cube.img`` of patches whose emissivities ripple over wavelength; its samples."""
    drawn = np.random.default_rng(15)
    wavelengths = wavelengths_um(bands)
    spectra = np.array(
        [
            np.clip(0.85 + 0.15 * np.sin(wavelengths * (3 + place)), 0.0, 1.0)
            * spectral_radiance(wavelengths, kelvin)
            for place, kelvin in enumerate(_KELVIN)
        ]
    )
    count = size // _BLOCK + 1
    patches = np.kron(drawn.integers(0, len(_KELVIN), (count, count)), np.ones((_BLOCK, _BLOCK)))
    places = patches[:size, :size].astype(np.intp)
    texture = 1.0 + 0.05 * drawn.standard_normal((size, size))
    cube = np.empty((bands, size, size), "<f4")
    for band in range(bands):
        cube[band] = spectra[places, band] * texture
    cube.tofile(folder / "cube.img")
    width = (HIGH_UM - LOW_UM) / bands
    header = (
        f"ENVI\nsamples = {size}\nlines = {size}\nbands = {bands}\nheader offset = 0\n"
        "data type = 4\ninterleave = bsq\nbyte order = 0\ndata units = W/m^2/sr/um\n"
        "wavelength units = um\n"
        f"wavelength = {{{', '.join(repr(float(one)) for one in wavelengths)}}}\n"
        f"fwhm = {{{', '.join([repr(width)] * bands)}}}\n"
    )
    (folder / "cube.img.hdr").write_text(header)
    return cube


class SpectralChain:
    """Cube, diffraction, picture; whatever is timed returns its own seconds.

    Parameters
    ----------
    folder : Path
        Where `write_cube` has written.
    size : int
        Samples across, and along.
    policy : Policy
        Precision, tolerance, threads.
    bands : "all" or "one"
        Every band by itself, or their integral.
    **optics
        Parameters of the diffraction.
    """

    def __init__(
        self, folder: Path, size: int, policy: Policy, *, bands: str = "all", **optics: Any
    ) -> None:
        field_deg = float(np.degrees(1e-3 * INTERVAL_MRAD * size))
        read = {"path": "cube.img", "bands": bands, "fov_x_deg": field_deg, "fov_y_deg": field_deg}
        if bands == "one":
            read |= {"cut_on_um": LOW_UM, "cut_off_um": HIGH_UM}
        nodes: dict[str, tuple[str, dict[str, Any]]] = {
            "read": ("read_image", read),
            "init": ("init_trans", {"focal_length_mm": 100.0, "f_number": 1.0}),
            "optics": ("diffraction_mtf", {"aperture_mm": APERTURE_MM, **optics}),
            "back": ("back_transform", {}),
        }
        links = [
            ("read.image", "init.image"),
            ("init.context", "optics.context"),
            ("init.magnitude", "optics.magnitude"),
            ("init.phase", "optics.phase"),
            ("optics.magnitude", "back.magnitude"),
            ("optics.phase", "back.phase"),
        ]
        network = Network(
            nodes={name: Node(name, key, params) for name, (key, params) in nodes.items()},
            links=tuple(Link.between(*link) for link in links),
        )
        self.policy = policy
        self.store = SceneStore()
        engine = Engine(standard_library(), self.store)
        self.plan = engine.plan(network, folder=folder)
        self.work = engine.work(policy)
        recipe = self.plan.output("back.image").recipe
        assert isinstance(recipe, Delivered)
        self.recipe = recipe

    def picture(self) -> NDArray[np.floating[Any]]:
        """What is delivered."""
        picture: NDArray[np.floating[Any]] = self.work.value(self.recipe)
        return picture

    def rank(self) -> WavelengthRank | None:
        """The wavelengths that stand for all."""
        return self.recipe.rank(self.work)

    def over_the_cube(self) -> float:
        """Seconds of the pass over the cube, the wavelengths being known."""
        assert self.recipe.weights is not None
        sums = self.recipe.filtered_sum.sums
        self._forget_all_but(sums.wavelengths)
        return self._seconds(sums)

    def behind_the_cube(self) -> float:
        """Seconds from the sums of bands to the picture, the planar factors being known."""
        if self.recipe.weights is None:
            sources = self.recipe.inputs
        else:
            sums = self.recipe.filtered_sum.sums
            sources = (sums.wavelengths, sums)
        self._forget_all_but(*sources, planes=True)
        return self._seconds(self.recipe)

    def choice(self) -> float:
        """Seconds of choosing the wavelengths."""
        assert self.recipe.weights is not None
        self.store.clear()
        return self._seconds(self.recipe.filtered_sum.wavelengths)

    def _seconds(self, recipe: Recipe) -> float:
        start = time.perf_counter()
        self.work.value(recipe)
        return time.perf_counter() - start

    def _forget_all_but(self, *recipes: Recipe, planes: bool = False) -> None:
        for recipe in recipes:
            self.work.value(recipe)
        suffix = f"/{self.policy.key}"
        kept = {recipe.key + suffix for recipe in recipes}
        if planes:
            self.work.value(self.recipe)
            kept |= {key for key in sorted(self.store.keys()) if self._is_planar(key)}
        self.store.forget_all_but(kept)

    def _is_planar(self, key: str) -> bool:
        return isinstance(self.store.peek(key), Precomputed)


_BANDS = 60
_REACH_T0, _REACH_ERROR = 6.0, 1e-5
_TOLERANCES = (1e-2, 2e-3, 2e-5)
_HEADS = {
    "way": "way",
    "wavelengths": "wavelengths",
    "bound": "bound",
    "error": "error of range",
    "cube_t0": "cube, T0",
    "t0": "behind it, T0",
    "choice_t0": "choice, T0",
    "reach": "limit",
    "verdict": "",
}


def bands(settings: Settings) -> list[Table]:
    """Sixty bands through diffraction: exact, few wavelengths, one, and one band in three ways."""
    size = settings.small
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        cube = write_cube(folder, size, _BANDS)
        truth = _band_by_band(cube)
        t0 = round_trip(np.ascontiguousarray(cube[0]), Policy().workers)
        pairs = 3 if settings.quick else 9
        ways: list[tuple[str, float | None]] = [
            ("every band", 0.0),
            *((f"tolerance {tolerance:g}", tolerance) for tolerance in _TOLERANCES),
            ("as it is used", None),
        ]
        for way, tolerance in ways:
            chain = SpectralChain(folder, size, Policy("single", tolerance))
            rank = chain.rank()
            assert rank is not None
            timing = paired(chain.behind_the_cube, t0, pairs=pairs, warm_up=1)
            error = _error(chain.picture(), truth)
            is_met = _REACH_T0 if tolerance == _TOLERANCES[1] else None
            rows.append(
                {
                    "way": way,
                    "wavelengths": len(rank.chosen),
                    "bound": rank.bound,
                    "error": error,
                    "cube_t0": paired(chain.over_the_cube, t0, pairs=pairs, warm_up=1)["t0"],
                    **timing,
                    "choice_t0": paired(chain.choice, t0, pairs=3, warm_up=1)["t0"],
                    "reach": is_met,
                    "verdict": "" if is_met is None else _verdict(timing["t0"], error),
                }
            )
        one_band: dict[str, dict[str, Any]] = {
            "one band, its middle": {"wavelengths": 1},
            "one band, uniform weights": {"weighting": "uniform"},
            "one band, photons of its mean": {},
        }
        for way, optics in one_band.items():
            chain = SpectralChain(folder, size, Policy("single"), bands="one", **optics)
            error = _error(chain.picture(), truth)
            timing = paired(chain.behind_the_cube, t0, pairs=pairs, warm_up=1)
            rows.append({"way": way, "error": error, **timing})
    text = (
        f"{_BANDS} bands from {LOW_UM:g} to {HIGH_UM:g} µm in a file, five materials, an aperture "
        f"of {APERTURE_MM:g} mm, single precision. T0 is a round trip of one band. The cube is "
        "read in one pass, then one transform is made per wavelength, and one back. The choice of "
        "wavelengths depends only on the optics and is kept. The bound applies to the rms of every "
        "band's contrast; the reference filters band by band in double precision. A single band "
        "has the spectrum of one wavelength, or of a black body, for the whole picture."
    )
    title = f"A cube of {_BANDS} bands through optics, {size}²"
    chart = Chart("error of range", "way")
    return [Table("bands", title, _HEADS, rows, text, chart)]


def _verdict(t0: float, error: float) -> str:
    if error > _REACH_ERROR:
        return f"missed: error {error:.1g}"
    return verdict(t0, _REACH_T0, None)


def _error(picture: Array, truth: Array) -> float:
    return float(np.abs(picture - truth).max() / np.ptp(truth))


def _band_by_band(cube: Array) -> Array:
    """Every band by a cosine transform of its own, with a disc's OTF (Goodman 2005, eq. 6-32)."""
    count, rows, columns = cube.shape
    xi = np.arange(columns) / (2 * columns * INTERVAL_MRAD)
    eta = np.arange(rows) / (2 * rows * INTERVAL_MRAD)
    rho = np.hypot(xi, eta[:, np.newaxis])
    total = np.zeros((rows, columns))
    for band, wavelength in zip(cube, wavelengths_um(count), strict=True):
        ratio = np.minimum(rho * wavelength / APERTURE_MM, 1.0)
        otf = 2.0 / np.pi * (np.arccos(ratio) - ratio * np.sqrt(1.0 - ratio**2))
        total += scipy.fft.idctn(scipy.fft.dctn(band.astype(float)) * otf)
    return np.asarray(total * ((HIGH_UM - LOW_UM) / count))


MEASURES = (bands,)
