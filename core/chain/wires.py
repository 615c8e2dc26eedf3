"""What travels on wires: small immutable recipes without arrays, and the results they make."""

from collections.abc import Iterable
from functools import cached_property
from typing import Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import NDArray

from core.arrays import Array
from core.chain.band_stack import BandStack
from core.errors import DataError, NetworkError, require_finite
from core.evaluation.recipes import Recipe, Step, content_key, ends_lineage
from core.evaluation.work import Work
from core.physics.atmosphere.air_path import AirPath
from core.physics.detector.detectivity import ResponseCurve
from core.physics.detector.focal_plane_array import Irradiance
from core.physics.optics.pupil_shapes import PupilShape
from core.physics.sampling.ground_geometry import OrbitView
from core.records import dataclass, field, replace
from core.transfer.factors import Edges, Factor, Grid, Separable, nyquist_lines
from core.transfer.periodic import fourier

# Computed values that are not plain arrays: curves, tables, sampled transfer functions.


@dataclass(frozen=True)
class Series:
    """One curve: abscissa and ordinate of equal length."""

    label: str
    x: NDArray[np.float64]
    y: NDArray[np.float64]


@dataclass(frozen=True)
class CurveMark:
    """An abscissa that is marked, such as the Nyquist frequency."""

    text: str
    x: float


@dataclass(frozen=True)
class CurveData:
    """Curves that share their axes, or bars that share their names.

    `bars` names the bars in order; each series then holds one height for each of them, at
    x = 0, 1, 2 and so on. With `log_y` the ordinate is shown by its logarithm, with `log_x` the
    abscissa; values that are infinite or not above 0 leave a gap. `marks` are abscissae to be
    marked.
    """

    title: str
    x_label: str
    y_label: str
    series: tuple[Series, ...]
    bars: tuple[str, ...] = ()
    log_y: bool = False
    log_x: bool = False
    marks: tuple[CurveMark, ...] = ()


@dataclass(frozen=True)
class TableRow:
    """A named figure; `reason` is why it has no value, where that is known."""

    name: str
    value: float | int | str | None
    unit: str = ""
    meaning: str = ""
    reason: str = ""


@dataclass(frozen=True)
class TableData:
    """Named figures in order."""

    rows: tuple[TableRow, ...]

    @classmethod
    def of(cls, *rows: tuple[Any, ...]) -> "TableData":
        return cls(tuple(TableRow(*row) for row in rows))

    def as_dict(self) -> dict[str, float | int | str | None]:
        return {row.name: row.value for row in self.rows}


@dataclass(frozen=True)
class SampledTransfer:
    """A transfer function at frequencies of its own, in FFT order."""

    values: NDArray[Any]
    interval_x: float
    interval_y: float


# A camera's data as its sheet gives them: entered once, and carried by the image.


@dataclass(frozen=True)
class CameraSheet:
    """What is known of the camera that takes an image; empty fields are None.

    A pitch is from one pixel to the next; `fill_x` and `fill_y` are its sensitive share. `f_number`
    is as the radiometry takes it, `aperture_mm` the diameter of the entrance pupil, as diffraction
    takes it. `obscuration_ratio` is the inner over the outer diameter of the aperture, `t_number`
    the F-number of a clear, lossless lens that gives the same light, `irradiance` how the light
    goes with either. `range_m` is the distance to the scene.
    """

    pixels_x: int | None = None
    pixels_y: int | None = None
    pitch_x_um: float | None = None
    pitch_y_um: float | None = None
    focal_length_mm: float | None = None
    f_number: float | None = None
    aperture_mm: float | None = None
    obscuration_ratio: float = 0.0
    t_number: float | None = None
    irradiance: Irradiance = "disc"
    fill_x: float | None = None
    fill_y: float | None = None
    range_m: float | None = None
    orbit: OrbitView | None = None

    @property
    def pitch_x_mrad(self) -> float | None:
        return _angle(self.pitch_x_um, self.focal_length_mm)

    @property
    def pitch_y_mrad(self) -> float | None:
        return _angle(self.pitch_y_um, self.focal_length_mm)


def _angle(pitch_um: float | None, focal_length_mm: float | None) -> float | None:
    return pitch_um / focal_length_mm if pitch_um and focal_length_mm else None


# What travels on wires: small immutable recipes that hold no arrays.

Platform = Literal["line", "push", "array"]


@dataclass(frozen=True)
class Header:
    """What an image's file states of the sensor that took it; empty fields are None.

    `bare_integers`: the file stores integers and names no unit of them. `unit_named`: it names one.
    `channels`: names of a colour picture's channels, of which the image is one; empty for a picture
    of one channel. `bands`: of the file, of which the image is one; 1 where it is made of several.
    `not_applied`: fields that would change the samples, which are as stored. `wavelengths_assumed`:
    it gives wavelengths without their unit, which are taken as µm. `absent_chunks`: files of a Zarr
    store that are not there, whose samples count as missing. `bad_bands`: how many bands the file
    marks as bad, which are left out. `coverage`: share of the wavelengths that its bands cover.
    """

    fov_x_deg: float | None = None
    fov_y_deg: float | None = None
    focal_length_mm: float | None = None
    bare_integers: bool = False
    channels: tuple[str, ...] = ()
    not_applied: tuple[str, ...] = ()
    unit_named: bool = False
    bands: int = 1
    wavelengths_assumed: bool = False
    absent_chunks: int = 0
    bad_bands: int = 0
    coverage: float = 1.0


def _bound(factors: Iterable[Factor]) -> tuple[Recipe, ...]:
    return tuple(recipe for factor in factors for law in factor.laws for recipe in law.inputs)


@dataclass(frozen=True)
class Image:
    """2-D samples with unit, sampling interval and band."""

    port_type: ClassVar[str] = "image"

    recipe: Recipe  # makes the pixels, shape (rows, columns)
    rows: int  # size
    columns: int
    interval_x_mrad: float | None = None  # sampling interval, None where it is not given
    interval_y_mrad: float | None = None
    unit: str = "W/m²/sr"  # unit of the samples
    band_um: tuple[float, float] | None = None  # cut-on and cut-off wavelength
    header: Header = Header()  # what the file states, for `Init & Trans`
    # How the frame goes on beyond its edges, as its transform had it; None where unknown.
    edges: Edges | None = None
    camera: CameraSheet | None = None  # the camera that takes it, where one was entered before
    # From one pixel of the detector to the next across and along, of that camera or Init & Trans.
    pixel_mrad: tuple[float | None, float | None] = (None, None)
    # The bands of wavelength that the pixels are the integral of, where they are known.
    bands: BandStack | None = None
    # What the air that it has come through consists of, all along one way.
    air: tuple[AirPath, ...] = ()
    # What has weighted its wavelengths behind the air: filters, a detector's material.
    responses: tuple[ResponseCurve, ...] = ()
    # Mean relative illumination of its frame; the scene before is so many times brighter.
    vignetting: float = 1.0
    # How long the detector collected it, and how often it takes a frame, where it says so.
    exposure_s: float | None = None
    frame_rate_Hz: float | None = None

    @property
    def key(self) -> str:
        return self.recipe.key

    @property
    def shape(self) -> tuple[int, int]:
        return self.rows, self.columns

    def with_recipe(self, recipe: Recipe, **changes: Any) -> "Image":
        """The same kind of image with other pixels; without bands, unless these are given too."""
        return replace(self, **{"recipe": recipe, "bands": None, **changes})

    def grid(self) -> Grid:
        if self.interval_x_mrad is None or self.interval_y_mrad is None:
            raise DataError(
                "the image has no sampling interval: set fov_x_deg and fov_y_deg on the node that "
                "reads the image"
            )
        return Grid(self.rows, self.columns, self.interval_x_mrad, self.interval_y_mrad)


MOST_STAGES = 5000  # in one chain: every wire has the list of all factors before it


def _chained(key: str, factors: tuple[Factor, ...]) -> str:
    for factor in factors:
        key = content_key(key, factor.key)
    return key


@dataclass(frozen=True)
class SpectrumWire:
    """Common part of `Magnitude` and `Phase`: an image's spectrum and the factors so far.

    `image` is None for a transfer function on its own ("just filter"): modulus 1, phase 0.
    """

    image: Image | None
    grid: Grid
    edges: Edges = "reflect"
    factors: tuple[Factor, ...] = ()

    @cached_property
    def key(self) -> str:
        source = self.image.key if self.image is not None else None
        return content_key(type(self).__name__, source, self.grid, self.edges, self._chained)

    @cached_property
    def _chained(self) -> str:
        """Key of the factors, made one by one so that a longer chain goes on from it."""
        return _chained("", self.factors)

    def _further(self, *factors: Factor) -> Self:
        """With further factors, whose keys alone are hashed."""
        if not factors:
            return self
        count = len(self.factors) + len(factors)
        if count > MOST_STAGES:
            raise NetworkError(
                f"{count:,} stages in one chain; at most {MOST_STAGES:,} are allowed"
            )
        longer = replace(self, factors=self.factors + factors)
        vars(longer)["_chained"] = _chained(self._chained, factors)
        return longer

    def only(self, *factors: Factor) -> Self:
        return replace(self, image=None, factors=factors)

    @property
    def pixel_mrad(self) -> tuple[float | None, float | None]:
        return (None, None) if self.image is None else self.image.pixel_mrad

    def transfer(
        self, part: Literal["mtf", "ptf"], factors: tuple[Factor, ...], label: str
    ) -> "Transfer":
        return Transfer(self.grid, part, factors, label, pixel_mrad=self.pixel_mrad)

    @property
    def recipes(self) -> tuple[Recipe, ...]:
        source = (self.image.recipe,) if self.image is not None else ()
        return (*source, *_bound(self.factors))


@dataclass(frozen=True)
class Magnitude(SpectrumWire):
    """The modulus of an image's spectrum with the MTF factors collected so far."""

    port_type: ClassVar[str] = "magnitude"
    times = SpectrumWire._further


@dataclass(frozen=True)
class Phase(SpectrumWire):
    """The phase of an image's spectrum with the PTF factors collected so far."""

    port_type: ClassVar[str] = "phase"
    plus = SpectrumWire._further


@dataclass(frozen=True)
class Transfer:
    """A transfer function to look at or plot; no factor is 1 (MTF) or 0 (PTF).

    `own`, for a function with frequency intervals of its own such as a raw autocorrelation, is
    the recipe of a `SampledTransfer`. `pixel_mrad` is from one pixel of the detector to the next,
    where that is known.
    """

    port_type: ClassVar[str] = "transfer"

    grid: Grid
    part: Literal["mtf", "ptf"]
    factors: tuple[Factor, ...] = ()
    label: str = field(default="", compare=False)
    own: Recipe | None = None
    pixel_mrad: tuple[float | None, float | None] = field(default=(None, None), compare=False)

    @cached_property
    def key(self) -> str:
        return content_key(
            "transfer", self.grid, self.part, tuple(f.key for f in self.factors), self.own
        )

    @property
    def recipes(self) -> tuple[Recipe, ...]:
        own = (self.own,) if self.own is not None else ()
        return (*own, *_bound(self.factors))

    def at(self, axis: str, frequency: float) -> Step:
        """Recipe of the MTF or PTF (rad) at one frequency along an axis, cycles/mrad."""
        how: Any = {"transfer": self, "axis": axis, "frequency": frequency}
        return Step.of(_value_at, *self.recipes, **how)


@dataclass(frozen=True)
class Context:
    """The data structure of Init & Trans: sampling, optics, detector, platform.

    Empty values are None; a module that needs one raises an error that names it.
    """

    port_type: ClassVar[str] = "context"

    grid: Grid
    edges: Edges
    platform: Platform
    detector_x_um: float | None
    detector_y_um: float | None
    focal_length_mm: float | None
    f_number: float | None
    range_m: float | None
    fill_x: float
    fill_y: float
    velocity_m_per_s: float
    scan_velocity_mrad_per_s: float
    band_um: tuple[float, float] | None = None
    aperture_mm: float | None = None
    obscuration_ratio: float = 0.0
    t_number: float | None = None
    irradiance: Irradiance = "disc"
    elevation_deg: float | None = None

    @cached_property
    def key(self) -> str:
        return content_key("context", *(getattr(self, name) for name in self.__dataclass_fields__))


@dataclass(frozen=True)
class _Figures:
    recipe: Recipe

    @property
    def key(self) -> str:
        return self.recipe.key


class Curve(_Figures):
    """One or more 1-D curves; `recipe` makes a `CurveData`."""

    port_type: ClassVar[str] = "curve"


class Table(_Figures):
    """Named figures with units; `recipe` makes a `TableData`."""

    port_type: ClassVar[str] = "table"


@dataclass(frozen=True)
class Pupil:
    """An exit pupil: a geometric shape, or samples, with a wavefront error in waves."""

    port_type: ClassVar[str] = "pupil"

    samples: Recipe  # makes the amplitude transmission, shape (rows, columns)
    rows: int  # size of the pupil array
    columns: int
    shape: PupilShape | None  # the geometry, where there is one
    # Radius of the disc on which the wavefront is defined, samples, centred on the array; None for
    # the smallest circle round the samples.
    radius: float | None
    defocus_waves: float = 0.0  # W20 at the rim
    zernike_waves: tuple[float, ...] = ()  # coefficients in Noll's order from piston on, waves rms
    # Makes a map of the wavefront error of the samples' shape, added to these, in waves of
    # `wavefront_um`.
    wavefront: Recipe | None = None
    # Wavelength of the map's waves; None for the mean of the band in which it is used.
    wavefront_um: float | None = None
    # Whether the map is known modulo a wave only, and so holds at its own wavelength alone.
    wrapped: bool = False

    @cached_property
    def key(self) -> str:
        return content_key("pupil", *(getattr(self, name) for name in self.__dataclass_fields__))

    @property
    def aberrated(self) -> bool:
        return bool(self.defocus_waves or any(self.zernike_waves) or self.wavefront is not None)


# A transfer function on the wire as a plane of numbers, and the spectrum of a picture.


def transfer_plane(
    work: Work, value: Transfer | SpectrumWire, xi: Array | None = None, eta: Array | None = None
) -> Array:
    """Product of the MTFs, or sum of the PTFs, at xi × eta (default: the plain FFT's).

    On the plain FFT's own frequencies it is what acts on a periodic frame: at the Nyquist row and
    column of an even size, the Hermitian part.
    """
    phase = value.part == "ptf" if isinstance(value, Transfer) else isinstance(value, Phase)
    if xi is not None and eta is not None:
        return _plane(work, value.factors, phase, xi, eta)
    xi, eta = value.grid.xi(), value.grid.eta()
    plane = np.array(_plane(work, value.factors, phase, xi, eta))

    def shown(x: Array, y: Array) -> Array:
        return _plane(work, value.factors, phase, x, y)

    def acting(x: Array, y: Array) -> Array:
        return _acting(work, value.factors, x, y)

    lines = zip(nyquist_lines(shown, xi, eta), nyquist_lines(acting, xi, eta), strict=True)
    for (place, mean), (_, acts) in lines:
        if phase:
            # Near the mean of the phases, which may be many turns.
            plane[place] = mean + np.angle(acts * np.exp(-1j * mean))
        elif np.iscomplexobj(acts):
            plane[place] = np.copysign(np.abs(acts), mean)
        else:
            plane[place] = acts
    return plane


@ends_lineage
def _value_at(work: Work, *_: Any, transfer: Transfer, axis: str, frequency: float) -> float:
    at, zero = np.array([frequency]), np.zeros(1)
    xi, eta = (at, zero) if axis == "x" else (zero, at)
    return float(transfer_plane(work, transfer, xi, eta)[0, 0])


def _plane(work: Work, factors: tuple[Factor, ...], phase: bool, xi: Array, eta: Array) -> Array:
    """The factors as wires show them: MTFs signed or as moduli, PTFs in radians."""
    plane = np.zeros((len(eta), len(xi))) if phase else np.ones((len(eta), len(xi)))
    for factor in factors:
        part = factor.plane(work, xi, eta)
        plane = plane + part if phase else plane * part
    return plane


def _acting(work: Work, factors: tuple[Factor, ...], xi: Array, eta: Array) -> Array:
    """The factors as they multiply a spectrum; of a modulus or a phase, the law it belongs to."""
    plane: Array = np.ones((len(eta), len(xi)))
    for factor in factors:
        if isinstance(factor, Separable):
            part = factor.plane(work, xi, eta)
            plane = plane * (part if factor.part == "mtf" else np.exp(1j * part))
        else:
            whole = factor if factor.take == "real" else replace(factor, take="complex")
            plane = plane * whole.transfer(work, xi[np.newaxis, :], eta[:, np.newaxis])
    return plane


@ends_lineage
def spectrum(work: Work, image: Array) -> Array:
    """Unnormalised plain FFT of the frame, its mean exact to double precision."""
    mean = float(np.mean(image, dtype=np.float64))
    centred = np.subtract(image, mean, dtype=work.policy.dtype)
    values = fourier().fft2(centred, workers=work.policy.workers)
    require_finite(values)
    values[0, 0] = mean * image.size
    return np.asarray(values)
