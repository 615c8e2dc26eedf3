"""Atmospheric Path: what the air takes from a picture's radiance, and what it adds."""

import math
import warnings
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

import numpy as np

from core.arrays import Array
from core.chain.band_stack import AttenuatedBands, BandStack
from core.chain.engine import PlannedNode
from core.chain.step_lineage import LevelChange, picture_step
from core.chain.wires import Context, Image, Table, TableData
from core.errors import DataError, ParameterError, how_to_install
from core.evaluation.recipes import Recipe, Step, in_blocks, pointwise
from core.evaluation.work import Work
from core.modules.declaration import Caution, Formula, Module, NodeContext, Section, param, warning
from core.modules.preview import Axis, Curve, Plot, Preview, brief
from core.physics.atmosphere.air_path import (
    AirPath,
    extinction_of_visibility,
    optical_depth,
    path_of_bands,
)
from core.physics.detector.photon_conversion import SHORTEST_THERMAL_UM
from core.physics.radiometry.planck import brightness_temperature
from core.physics.radiometry.spectra import SUNLIGHT_K
from core.physics.sampling.ground_geometry import EARTH_RADIUS_KM as R
from core.records import replace
from nodes.files.curve_tables import Points, read_path_table, read_wavelengths
from nodes.shared.context_defaults import apart_caution, first, watts_factor
from nodes.shared.module_ports import PictureTable, TableFigures, WeightingSource
from nodes.shared.steps import AboutMean, mean_of

_PREVIEW_POINTS = 401
_ROOM = 1.2  # above a transmission of 1, whose tick the title would hide
_TITLE = "wavelength (µm)"
_NEEDED = (
    "Atmospheric Path needs radiance in W/m²/sr; set the unit on Read Image, or convert "
    "temperatures with To Radiance"
)
_TABLES = {"modtran": "the MODTRAN file contains", "modtran_tables": "the MODTRAN tables contain"}


class AtmosphericPath(Module, key="atmospheric_path", title="Atmospheric Path", group="Atmosphere"):
    """Attenuate a picture's radiance by the atmosphere, and add the path radiance: τ·L + L_path.

    `transmission`: a number, or a CSV of wavelength (µm) and transmission. `extinction_per_km`: the
    transmission is exp(−β·R). `visibility_km`: Koschmieder's β = 3.912/V at 0.55 µm, times
    (0.55/λ)^q. `modtran`: a tape7 or the JSON output of MODTRAN (columns FREQ, TOT TRANS and the
    path radiances; 10⁸/λ² converts W/cm²/sr per cm⁻¹ to W/m²/sr/µm), or a CSV of wavelength_um,
    transmission, path_radiance (W/m²/sr/µm). MODTRAN's data contain the path radiance; with other
    models, it is (1 − τ) times the radiance of a black body at `air_K`.

    `modtran_tables`: pyBSM's tables of MODTRAN 5.2.1, 0.3 to 14 µm, for a target on the ground, a
    mid-latitude summer and the sun 40° above the horizon. Between the tables, −ln τ/R and L_path/(1
    − τ) are interpolated over height and ground range. With every second table left out as a test,
    a band's transmission is off by 0.007 rms and 0.06 at most. Air above 24.5 km is neglected: at
    nadir, from 0.5 to 0.8 µm, this raises the transmission from 0.681 to 0.688. Install the extra
    `atmosphere` to use `modtran_tables`.

    A picture with one band is multiplied by the band's mean transmission. The mean is weighted by
    the radiance of a black body. The black body's temperature is `source_K` if given, otherwise
    5800 K (sunlight) if the band begins below 2.5 µm, otherwise the picture's mean brightness
    temperature. In a spectral picture (`bands` of Read Image), each band is multiplied by its own
    transmission. Absorption and scattering both count as attenuation here; for the blur from
    scattering, use Atmosphere MTF. A Figures of Merit module after this one scales the transmission
    to each range with Beer's law at every wavelength. Two Atmospheric Path modules in a row
    represent two constituents of the same air. Put the module after Camera to use Camera's range
    and orbit; otherwise enter `range_m` here.

    Sources: Bouguer 1729; Koschmieder 1924; Ångström 1929; Berk et al. 2011 (MODTRAN).
    """

    formulas = (
        Formula(
            r"L'=\tau\,L+L_{path}",
            where="τ: transmission; L_path: path radiance of the air, W/m²/sr",
        ),
        Formula(
            r"\tau=e^{-\beta R},\quad L_{path}=(1-\tau)\,L_B(T_{air})",
            where="β: extinction, 1/km; R: range, km; T_air: air_K; with air_K empty, there is "
            "no path radiance",
            when="models without MODTRAN",
        ),
        Formula(
            r"\beta=\frac{3.912}{V}\left(\frac{0.55}{\lambda}\right)^q",
            where="V: visibility, km; λ in µm; q: angstrom_q",
            when="visibility_km",
        ),
    )

    model: Literal[
        "transmission", "extinction_per_km", "visibility_km", "modtran", "modtran_tables"
    ] = param(
        "transmission",
        "model of the air: a transmission, an extinction, a visibility, a MODTRAN file, or "
        "pyBSM's MODTRAN tables",
    )
    transmission: float = param(1.0, "transmission of the path", (0, 1))
    path: Path | None = param(
        None,
        "CSV of wavelength (µm) and transmission, used instead of `transmission`; for "
        "modtran: a tape7, JSON or CSV",
    )
    extinction_per_km: float = param(
        0.2, "extinction coefficient: absorption plus scattering", (0, 1e6), slider=(0, 2)
    )
    visibility_km: float = param(
        23.0, "visibility (2 % contrast)", (0, 1e6), above=True, slider=(1, 50)
    )
    angstrom_q: float = param(
        0.0,
        "Ångström exponent q: the extinction coefficient is proportional to wavelength^−q",
        (-5, 5),
        slider=(0, 2),
    )
    haze: Literal["rural_23_km", "rural_5_km"] = param(
        "rural_23_km", "haze type and visibility of MODTRAN's tables"
    )
    altitude_m: float | None = param(
        None,
        "height of the camera above the ground, for MODTRAN's tables; empty: from Camera's orbit",
        (0, 1e8),
        slider=(2, 20000),
    )
    range_m: float | None = param(
        None,
        "length of the path; empty: from a Camera before this node, or from Init & Trans if "
        "context is connected",
        (0, 1e9),
        slider=(10, 20000),
    )
    air_K: float | None = param(
        None, "temperature of the air; empty: no path radiance", (0, 1e4), slider=(230, 320)
    )
    source_K: WeightingSource = None

    preview_lines = 15.0
    panel = (
        Section("", "model"),
        Section("Air", "transmission", shown_when=("model", ("transmission",))),
        Section("", "path", shown_when=("model", ("transmission", "modtran"))),
        Section("", "extinction_per_km", shown_when=("model", ("extinction_per_km",))),
        Section("", "visibility_km angstrom_q", shown_when=("model", ("visibility_km",))),
        Section("", "haze altitude_m", shown_when=("model", ("modtran_tables",))),
        Section("Path", "range_m air_K"),
        Section("Band", "source_K"),
    )

    def check(self) -> None:
        if self.model == "modtran" and self.path is None:
            raise ParameterError(
                "path",
                None,
                "give a MODTRAN tape7 or JSON file, or a CSV of wavelength_um, "
                "transmission and path_radiance",
            )

    def run(self, image: Image, here: NodeContext, context: Context | None = None) -> PictureTable:
        factor = watts_factor(image.unit, temperature="a temperature", needed=_NEEDED)
        air = self.air(image, here, context)
        band = image.band_um
        if band is None and not (air.is_grey and air.air_K is None and not air.radiance):
            raise DataError(
                "the image has no band, so the transmission and path radiance are "
                "unknown: set cut_on_um and cut_off_um on Read Image"
            )
        if band is not None:
            air.require_covered(*band)
            air = air.within_band(*band)
        if image.bands is not None:
            return self._by_bands(image, image.bands, air, here)
        how: dict[str, Any] = {"air": air, "band_um": band, "source_K": self.source_K or SUNLIGHT_K}
        scene = self._scene(image, air, factor, here)
        over = here.step(path_over_band, *scene, **how)
        table = Table(here.step(path_table, over, *scene, **how))
        if air.is_clear:
            return PictureTable(image, table)
        made = here.step(through_air, image.recipe, over, factor=factor)
        return PictureTable(image.with_recipe(made, air=(*image.air, air)), table)

    def preview(self, planned: PlannedNode, work: Work, _here: NodeContext) -> Preview:
        table: Any = planned.sound().outputs["table"]
        figures, how = work.value(table.recipe).as_dict(), dict(table.recipe.parameters)
        air, band = how["air"], how["band_um"]
        words = [f"mean band transmission {brief(figures['transmission'])}"]
        if figures["path_radiance"] > 0.0:
            words.append(f"path radiance {brief(figures['path_radiance'])} W/m²/sr")
        if band is None:
            return Preview("; ".join(words), ("; ".join(words),))
        places = _places(air.points, *band)
        transmission, added = np.exp(-air.depth(places)), air.added(places)
        least, most = transmission.min(), transmission.max()
        if brief(least) != brief(most):
            words.insert(1, f"from {brief(least)} to {brief(most)} within the band")
        passed = Curve(places, transmission)
        across, along = Axis(band[0], band[1], _TITLE), Axis(0.0, _ROOM, "transmission", reach=1.0)
        if not added.max() > 0.0:
            return Preview("; ".join(words), (Plot(across, along, (passed,)),))
        radiance = Axis(0.0, _ROOM * float(added.max()), "path radiance (W/m²/sr/µm)")
        above = Plot(replace(across, title=""), along, (passed,))
        below = Plot(across, radiance, (Curve(places, added, 1, fill="below"),))
        return Preview("; ".join(words), (above, below))

    def _by_bands(
        self, image: Image, bands: BandStack, air: AirPath, here: NodeContext
    ) -> PictureTable:
        gain, offset = path_of_bands(air, bands.centres_um, bands.widths_um)
        light = {"weights": bands.whole, "gain": gain, "offset": offset}
        over = here.step(path_over_bands, bands.means(), **light)
        how = {"air": air, "band_um": image.band_um, "source_K": None}
        table = Table(here.step(path_table, over, **how))
        if air.is_clear:
            return PictureTable(image, table)
        stack = AttenuatedBands.of(bands, gain=gain, offset=offset, node=here.node)
        made = stack.picture(stack.whole)
        return PictureTable(image.with_recipe(made, bands=stack, air=(*image.air, air)), table)

    def air(self, image: Image, here: NodeContext, context: Context | None) -> AirPath:
        of_camera = None if image.camera is None else image.camera.range_m
        range_m = self.range_m or of_camera or (None if context is None else context.range_m)
        given: dict[str, Any] = {"range_m": range_m, "air_K": self.air_K}
        if self.model == "modtran":
            assert self.path is not None
            points, radiance = read_path_table(here.folder / self.path)
            return AirPath(points=points, radiance=radiance, **given)
        if self.model == "modtran_tables":
            points, radiance = self._tables(image, range_m)
            return AirPath(points=points, radiance=radiance, **given)
        if self.model == "extinction_per_km":
            return AirPath(extinction_per_km=self.extinction_per_km, **given)
        if self.model == "visibility_km":
            extinction = extinction_of_visibility(visibility_km=self.visibility_km)
            return AirPath(extinction_per_km=extinction, angstrom_q=self.angstrom_q, **given)
        if self.path is None:
            return AirPath(transmission=self.transmission, **given)
        path = here.folder / self.path
        points = read_wavelengths(path, what="transmission", low=0.0, high=1.0)
        return AirPath(points=points, **given)

    def _tables(self, image: Image, range_m: float | None) -> tuple[Points, Points]:
        altitude_m = self.altitude_m or _orbit_altitude_m(image)
        if altitude_m is None:
            raise ParameterError(
                "altitude_m", None, "give a value here, or altitude_km on a Camera before this node"
            )
        if range_m is None:
            allowed = "give a value here, or on a Camera before this node"
            raise ParameterError("range_m", None, allowed)
        ihaze = 1 if self.haze == "rural_23_km" else 2
        return table_path(height_km=altitude_m / 1e3, range_km=range_m / 1e3, ihaze=ihaze)

    def _scene(
        self, image: Image, air: AirPath, factor: float, here: NodeContext
    ) -> tuple[Recipe, ...]:
        band = image.band_um
        if band is None or air.is_grey or self.source_K is not None:
            return ()
        if band[0] < SHORTEST_THERMAL_UM:
            return ()
        how = {"factor": factor, "band_um": band}
        return (here.step(scene_temperature, image.recipe, **how),)

    @warning
    def unused(self, given: frozenset[str]) -> Caution | None:
        """The model does not use a number or file that is entered."""
        if self.model in _TABLES and self.air_K is not None:
            return Caution(
                f"air_K = {self.air_K:g} K is not used: {_TABLES[self.model]} the path radiance",
                "leave air_K empty",
            )
        if self.path is None:
            return None
        if self.model == "transmission" and "transmission" in given and self.transmission != 1.0:
            return Caution(
                f"transmission = {self.transmission:g} is not used: the transmission comes "
                "from the file in path",
                "set transmission to 1, or leave path empty",
            )
        if self.model in ("extinction_per_km", "visibility_km", "modtran_tables"):
            return Caution(
                f"path is not used by model = {self.model}",
                "set model to transmission or modtran to use the file, or leave path empty",
            )
        return None

    @warning
    def dark_air(self, image: Image, outputs: PictureTable) -> Caution | None:
        """The air attenuates a thermal scene but adds no path radiance."""
        if self.model in _TABLES or self.air_K is not None or image.band_um is None:
            return None
        if image.band_um[0] < SHORTEST_THERMAL_UM or outputs.image.air == image.air:
            return None
        return Caution(
            "the scene will look colder than it does through real air: air_K is empty, so the air "
            "attenuates the thermal scene but adds no path radiance",
            "give air_K, the temperature of the air",
        )

    @warning
    def source(self, image: Image) -> Caution | None:
        """A black-body temperature is entered but not used: the picture has several bands."""
        if self.source_K is None or image.bands is None:
            return None
        return Caution(
            f"source_K = {self.source_K:g} K is not used: the picture has {image.bands.count} "
            "bands, each with its own transmission",
            "leave source_K empty",
        )

    @warning
    def ranges(self, image: Image, context: Context | None) -> Caution | None:
        """The range differs from the range of the camera or of another Atmospheric Path."""
        of_camera = None if image.camera is None else image.camera.range_m
        of_context = None if context is None else context.range_m
        own = self.range_m or of_camera or of_context
        above = _orbit_altitude_m(image)
        return first(
            apart_caution("altitude_m", self.altitude_m, above, where="on Camera"),
            apart_caution("range_m", self.range_m, of_camera, where="on Camera"),
            apart_caution("range_m", own, of_context, where="on Init & Trans"),
            *(
                apart_caution(
                    "range_m", own, before.range_m,
                    where="on the Atmospheric Path before this node",
                    remedy="two Atmospheric Paths in a row represent constituents of the same "
                           "air: give both the same range",
                )
                for before in image.air
            ),
        )  # fmt: skip

    figures = TableFigures(
        ("transmission", "", "Mean transmission over the band, weighted by the spectrum of the "
                             "light."),
        ("path_radiance", "W/m²/sr", "Path radiance, integrated over the band."),
        ("optical_depth", "", "Optical depth: −ln of the band's transmission; empty if no light "
         "passes."),
    )  # fmt: skip


def _orbit_altitude_m(image: Image) -> float | None:
    orbit = None if image.camera is None else image.camera.orbit
    return None if orbit is None else 1000.0 * orbit.altitude_km


Band = tuple[float, float]
Row = tuple[float, ...]
Over = tuple[float, float]  # mean transmission of a path over a band, and its path radiance
_LISTED = 21  # wavelengths in the table


@in_blocks()
def scene_temperature(work: Work, samples: Array, *, factor: float, band_um: Band) -> float:
    """Brightness temperature of a picture's mean; `factor` makes W/m²/sr of its samples."""
    mean = factor * float(np.mean(samples, dtype=np.float64))
    if not (math.isfinite(mean) and mean > 0.0):
        raise DataError(
            f"the transmission cannot be weighted: a picture with mean radiance {mean:g} W/m²/sr "
            "has no brightness temperature; give source_K"
        )
    low, high = band_um
    return float(brightness_temperature(radiance=mean, cut_on_um=low, cut_off_um=high))


def path_over_band(
    work: Work, *scene_K: float, air: AirPath, band_um: Band | None, source_K: float
) -> Over:
    if band_um is None:  # a path that is grey and adds nothing
        return math.exp(-float(air.depth(1.0))), 0.0
    return air.over_band(*band_um, source_K=scene_K[0] if scene_K else source_K)


def path_over_bands(work: Work, means: Array, *, weights: Row, gain: Row, offset: Row) -> Over:
    added = float(np.dot(weights, offset))
    if min(gain) == max(gain):
        return gain[0], added
    light = np.maximum(means * np.array(weights), 0.0)
    total = float(light.sum())
    if not total > 0.0:
        raise DataError(
            "the transmission cannot be weighted: the mean radiance of the picture's bands is not "
            "above 0"
        )
    return min(float(light @ np.array(gain)) / total, 1.0), added


def dimming(work: Work, mean: float, over: Over) -> LevelChange:
    return LevelChange(over[0], mean, over[0] * mean)


@picture_step(
    linear=lambda image, over, **_: AboutMean(
        Step.of(dimming, Step.of(mean_of, image), over), of_air=True
    )
)
@pointwise
def through_air(work: Work, image: Array, over: Over, *, factor: float) -> Array:
    """τ·L + L_path; `factor` makes W/m²/sr of the samples."""
    number = work.policy.dtype.type
    made = np.multiply(image, number(over[0]), dtype=work.policy.dtype)
    made += number(over[1] / factor)
    return made


def path_table(
    work: Work, over: Over, *scene_K: float, air: AirPath, band_um: Band | None, source_K: Any
) -> TableData:
    transmission, radiance = over
    depth = optical_depth(transmission=transmission) if transmission > 0.0 else None
    weighted_by = None if air.is_grey else (scene_K[0] if scene_K else source_K)
    rows: list[tuple[Any, ...]] = [
        ("transmission", transmission),
        ("path_radiance", radiance),
        ("optical_depth", depth),
        ("range_m", air.range_m, "m", "range for which the transmission holds"),
        ("weighted_by_K", weighted_by, "K",
         "temperature of the black body whose spectrum weights the mean"),
    ]  # fmt: skip
    places = np.empty(0) if band_um is None else np.linspace(*band_um, _LISTED)
    values = zip(places, np.exp(-air.depth(places)), air.added(places), strict=True)
    for place, passed, added in values:
        at = f"at {place:.4g} µm"
        rows.append((f"transmission_{place:.6g}_um", float(passed), "", at))
        rows.append((f"path_radiance_{place:.6g}_um", float(added), "W/m²/sr/µm", at))
    return AtmosphericPath.figures.table(*rows)


def _places(points: tuple[tuple[float, float], ...], low: float, high: float) -> Array:
    """Wavelengths of the preview: evenly over the band, and where a table has its points."""
    known = np.array([place for place, _ in points])
    inside = known[(known >= low) & (known <= high)]
    return np.unique(np.concatenate([np.linspace(low, high, _PREVIEW_POINTS), inside]))


# Paths to the ground from pyBSM's tables, which MODTRAN 5.2.1 computed.
#
# Between them the mean extinction per km, −ln τ/R, and the source L/(1 − τ) are straight along the
# ground and in the logarithm of the height. With every second table left out, band means of the
# transmission are within 0.001 rms (at most 0.03) along the ground and 0.007 (0.06) in height,
# those of the path radiance within 1.3 % and 2.3 % rms.
#
# Source: LeMaster and Eismann 2017, pyBSM, Proc. SPIE 10204 (Apache License 2.0).

_HEIGHTS = (0.002, 0.0325, 0.075, 0.15, 0.225, 0.5, *range(1, 13), 14, 16, 18, 20, 24.5)
_DISTANCES = (0, 0.1, 0.5, *range(1, 20), *range(20, 80, 2), *range(80, 305, 5))  # km, both


@lru_cache(maxsize=8)
def table_path(*, height_km: float, range_km: float, ihaze: int) -> tuple[Points, Points]:
    """Transmission and path radiance (W/m²/sr/µm) against wavelength in µm, rising.

    `height_km` is the camera's above the target, `range_km` the length of the line of sight;
    `ihaze` is 1 for 23 km of visibility and 2 for 5 km. A camera above the highest table, 24.5 km,
    sees the air below that height.
    """
    try:
        with warnings.catch_warnings():  # pyBSM sets filters
            from pybsm.utils import load_database_atmosphere_no_interp as load
    except ImportError as error:
        needed = f"the package pybsm: {how_to_install('atmosphere')}"
        raise DataError(f"model = modtran_tables needs {needed}") from error
    if not height_km >= _HEIGHTS[0]:
        raise ParameterError("altitude_m", 1e3 * height_km, "2 or more")
    if range_km < height_km * (1.0 - 1e-9):
        allowed = f"at least the altitude, {1e3 * height_km:g} m"
        raise ParameterError("range_m", 1e3 * range_km, allowed)
    # Sine of the elevation at the target, and what of the path lies in the tables.
    sine = min((height_km * (2 * R + height_km) - range_km**2) / (2 * R * range_km), 1.0)
    beyond = ParameterError(
        "range_m", 1e3 * range_km, "at most 300 km along the ground, and not beyond the horizon"
    )
    if sine < 0.0:
        raise beyond
    height = min(height_km, _HEIGHTS[-1])
    square = height * (2 * R + height)
    length = square / (math.sqrt((R * sine) ** 2 + square) + R * sine)
    ground = R * math.asin(min(length * math.sqrt(1.0 - sine * sine) / (R + height), 1.0))
    if ground > _DISTANCES[-1]:
        raise beyond
    depth, source = np.zeros((2, 1))
    for h, by_height in _around(_HEIGHTS, height, math.log):
        for g, along in _around(_DISTANCES, ground, float):
            try:
                table = load(altitude=1e3 * h, ground_range=1e3 * g, ihaze=ihaze)
            except IndexError:
                raise beyond from None
            passed = np.asarray(table[:, 1], np.float64)
            added = np.asarray(table[:, 2] + table[:, 4], np.float64) / 1e6
            slant = math.hypot(h, 2.0 * math.sqrt(R * (R + h)) * math.sin(g / R / 2.0))
            depth = depth - by_height * along * np.log(np.maximum(passed, 1e-30)) / slant
            source = source + by_height * along * added / np.maximum(1.0 - passed, 1e-6)
    transmission = np.minimum(np.exp(-depth * length), 1.0)
    radiance = source * (1.0 - transmission)
    points = np.stack([1e6 * table[:, 0], transmission, radiance], axis=1).tolist()
    return tuple((um, t) for um, t, _ in points), tuple((um, r) for um, _, r in points)


def _around(places: tuple[float, ...], place: float, scale: Any) -> list[tuple[float, float]]:
    """The places on both sides and their weights; one where it is one of them."""
    index = int(np.clip(np.searchsorted(places, place), 1, len(places) - 1))
    low, high = places[index - 1 : index + 1]
    share = (scale(place) - scale(low)) / (scale(high) - scale(low))
    return [one for one in ((low, 1.0 - share), (high, share)) if abs(one[1]) > 1e-9]
