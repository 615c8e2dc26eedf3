"""Every test scene: drawn at once, or as the shares of its surfaces; in one band or in many.

A scene is Σ_k a_k(x, y)·s_k(λ), with the shares a_k of its surfaces and textures and their spectra
s_k, so that no band need be drawn by itself and no cube is ever in memory.
"""

from collections.abc import Mapping
from functools import cache
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, get_args

import numpy as np
import numpy.typing as npt

from core.arrays import Floats
from core.errors import ParameterError
from core.physics.radiometry.planck import band_radiance
from core.physics.radiometry.spectra import (
    SUNLIGHT_K,
    CoarseSpectrum,
    mean_by_planck,
    white_surface_radiance,
)
from nodes.scenes import coverage, scene_canvas
from nodes.scenes.drawn_scenes import airfield, dormitory

Emissivity = Literal["spectra", "grey"]


def surface_spectra(
    *,
    edges_um: Floats,
    temperature_K: float,
    delta_K: float,
    emissivity: Emissivity,
    sun_elevation_deg: float,
    reflectance: bool = False,
) -> dict[str, Floats]:
    """Spectral radiance of every surface, the mean over each band, (bands,) [W m⁻² sr⁻¹ µm⁻¹].

    L = ε·L(T) + (1 − ε)·(L_sky + L_sun), where L_sky is the zenith's and L_sun that of a level,
    white, matt surface in the Sun (`sun_elevation_deg` 0: none). Every surface is lit as level
    ground is; those in the shade see the sky alone. ε is the mean over the band by the light in
    question: of `materials`, or grey, one number a surface, as without bands. `edges_um` (bands +
    1,) ascend. With `reflectance`, what a level, white, matt surface in the Sun would have to
    reflect to look as bright in sunlight alone: (1 − ε)·(1 + ρ_sky), in the shade (1 − ε)·ρ_sky.
    """
    kelvins = surface_temperatures(temperature_K=temperature_K, delta_K=delta_K)
    names = list(SURFACES)
    sky_K = float(kelvins[names.index("zenith")])
    groups = _groups(emissivity)
    zenith = next(one for one, places in groups if names.index("zenith") in places)
    mirrors = np.array([name not in SKY for name in names])
    lit = np.array([name not in SHADED for name in names])
    spectra = np.empty((len(names), len(edges_um) - 1))
    for band, (low, high) in enumerate(pairwise(edges_um.tolist())):
        ends = {"cut_on_um": low, "cut_off_um": high}
        own = band_radiance(temperature_K=np.array([*kelvins, sky_K]), **ends)
        sun = white_surface_radiance(sun_elevation_deg=sun_elevation_deg, **ends)
        # Shares that are reflected: of a surface's own light, of light as the sky's and the Sun's,
        # and of that as much as the sky itself reflects.
        once, twice = np.empty((3, len(names))), np.empty((2, len(names)))
        for spectrum, places in groups:
            lights = np.array([*kelvins[places], sky_K, SUNLIGHT_K])
            means = mean_by_planck(spectrum, temperature_K=lights, **ends)
            once[0, places], once[1:, places] = means[:-2], means[-2:, None]
            means = mean_by_planck(spectrum, zenith, temperature_K=lights[-2:], **ends)
            twice[:, places] = means[:, None]
        if reflectance:
            spectra[:, band] = once[2] * lit + twice[1] * mirrors
            continue
        light = (1.0 - once[0]) * own[:-1] + once[2] * sun * lit
        light += ((once[1] - twice[0]) * own[-1] + twice[1] * sun) * mirrors
        spectra[:, band] = light / (high - low)
    return dict(zip(names, spectra, strict=True))


def _groups(emissivity: Emissivity) -> list[tuple[CoarseSpectrum, list[int]]]:
    groups: dict[CoarseSpectrum, list[int]] = {}
    for place, (_, grey, material) in enumerate(SURFACES.values()):
        spectrum = materials()[material]
        if emissivity == "grey":
            spectrum = ((1.0, 1.0 - grey),)
        groups.setdefault(spectrum, []).append(place)
    return list(groups.items())


@cache
def materials() -> Mapping[str, CoarseSpectrum]:
    path = Path(__file__).with_name("materials.csv")
    rows = (line.split(",") for line in path.read_text("utf-8").splitlines() if line[0] != "#")
    pairs = {name: [point.split() for point in points] for name, *points in rows}
    return {
        name: tuple((float(um), float(percent) / 100.0) for um, percent in of)
        for name, of in pairs.items()
    }


# Surfaces of the drawn scenes: how warm each is, how much of the sky it mirrors, what it is of.

SKY_OFFSET = -2.6
"""The zenith, and what surfaces mirror of it, in units of delta_K from temperature_K."""

SURFACES: Mapping[str, tuple[float, float, str]] = MappingProxyType(
    {
        # name: (offset from temperature_K in units of delta_K, emissivity where grey, material)
        "zenith": (SKY_OFFSET, 1.0, "clear sky"),
        "horizon": (-1.45, 1.0, "haze"),
        "cloud": (-1.9, 1.0, "cloud"),
        "hills": (-0.95, 0.97, "leaves"),
        "brick": (0.25, 0.94, "brick"),
        "brick_shade": (0.02, 0.94, "brick"),
        "mortar": (-0.12, 0.91, "concrete"),
        "concrete": (0.60, 0.92, "concrete"),
        "coping": (-0.45, 0.90, "concrete"),
        "slab": (0.85, 0.92, "concrete"),
        "roof": (-0.9, 0.90, "roofing"),
        "metal": (-0.1, 0.55, "weathered zinc"),
        "vent": (0.9, 0.85, "painted metal"),
        "exhaust": (1.5, 0.95, "painted metal"),
        "plume": (-0.2, 1.0, "cloud"),
        "frame": (-0.20, 0.75, "white paint"),
        "glass_cool": (-0.45, 0.84, "window glass"),
        "glass_mid": (0.15, 0.84, "window glass"),
        "glass_lit": (1.05, 0.86, "window glass"),
        "glass_open": (1.5, 0.95, "rubber"),
        "door": (1.35, 0.90, "painted metal"),
        "grille": (1.2, 0.90, "painted metal"),
        "lawn": (-0.5, 0.98, "grass"),
        "lawn_near": (-0.2, 0.98, "grass"),
        "asphalt": (0.6, 0.95, "asphalt"),
        "paving": (0.42, 0.93, "concrete"),
        "joint": (0.05, 0.95, "asphalt"),
        "marking": (0.45, 0.90, "white paint"),
        "kerb": (0.20, 0.92, "concrete"),
        "shade": (-0.95, 0.98, "grass"),
        "bark": (-0.45, 0.95, "bark"),
        "leaf_cool": (-1.25, 0.97, "leaves"),
        "leaf_warm": (-0.42, 0.97, "leaves"),
        "car_cool": (-0.35, 0.90, "painted metal"),
        "car_warm": (0.55, 0.92, "painted metal"),
        "car_glass": (-0.95, 0.85, "window glass"),
        "engine": (1.7, 0.92, "painted metal"),
        "tyre": (0.95, 0.95, "rubber"),
        "lamp": (1.4, 0.95, "window glass"),
        "soil": (0.6, 0.95, "soil"),
        "water": (-1.25, 0.97, "water"),
    }
)

SKY = ("zenith", "horizon", "cloud", "plume")
"""They mirror nothing: their light comes straight from them."""

SHADED = ("shade", "brick_shade", "glass_open", "grille")
"""They see the sky, and not the Sun."""


def surface_temperatures(*, temperature_K: float, delta_K: float) -> Floats:
    """Temperature of each of `SURFACES` [K]; parameters and error as `surface_radiance`."""
    offsets = np.array([offset for offset, _, _ in SURFACES.values()])
    temperatures = temperature_K + offsets * delta_K
    if not float(temperatures.min()) > 0.0:
        low, high = -temperature_K / offsets.max(), -temperature_K / offsets.min()
        allowed = f"above {low:g} and below {high:g} for this scene"
        raise ParameterError("delta_K", delta_K, allowed)
    return np.asarray(temperatures)


def surface_radiance(
    *, cut_on_um: float, cut_off_um: float, temperature_K: float, delta_K: float
) -> dict[str, float]:
    """Band radiance of every surface, emitted and mirrored [W m⁻² sr⁻¹].

    L = emissivity·L_band(T) + (1 - emissivity)·L_band(T_sky), with opaque grey surfaces that
    see the sky by reflection; they differ from the air's temperature_K by steps of delta_K.
    """
    temperatures = surface_temperatures(temperature_K=temperature_K, delta_K=delta_K)
    emissivity = np.array([share for _, share, _ in SURFACES.values()])
    own = np.asarray(
        band_radiance(cut_on_um=cut_on_um, cut_off_um=cut_off_um, temperature_K=temperatures)
    )
    sky = own[list(SURFACES).index("zenith")]
    total = emissivity * own + (1.0 - emissivity) * sky
    return dict(zip(SURFACES, total.tolist(), strict=True))


Kind = Literal[
    "dormitory",
    "airfield",
    "slanted_edge",
    "four_bar",
    "siemens_star",
    "point",
    "sine",
    "two_panel",
    "uniform",
]
KINDS: tuple[Kind, ...] = get_args(Kind)

DRAWN = {"dormitory": dormitory, "airfield": airfield}
"""Scenes of many surfaces; all others are a black target on a black background."""

_LEVELS = ("background", "signal")

MOST_SAMPLES = 1280 * 1024
"""Larger scenes are drawn at once."""

GEOMETRY: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "dormitory": (),
        "airfield": (),
        "slanted_edge": ("angle_deg",),
        "siemens_star": ("frequency",),
    }
)
"""Scenes drawn in two steps, and the parameters beside the size that place their surfaces."""

Shares = scene_canvas.Layers | npt.NDArray[np.floating]
"""Of every surface, or of the signal against the background."""

Spectra = Mapping[str, Floats]
"""Of every surface and texture, or of background and signal: (bands,), W m⁻² sr⁻¹ µm⁻¹."""


def scene_radiances(
    *,
    kind: str,
    cut_on_um: float,
    cut_off_um: float,
    temperature_K: float,
    delta_K: float,
    reflectances: tuple[float, float] | None = None,
) -> scene_canvas.Radiances:
    """Band radiance of each of a scene's surfaces, or of background and signal [W m⁻² sr⁻¹].

    Targets are black, `delta_K` warmer than a background of `temperature_K`; or their
    `reflectances`, of background and signal, are given.
    """
    if reflectances is not None:
        return dict(zip(_LEVELS, reflectances, strict=True))
    ends = {"cut_on_um": cut_on_um, "cut_off_um": cut_off_um}
    if kind in DRAWN:
        return surface_radiance(**ends, temperature_K=temperature_K, delta_K=delta_K)
    kelvins = np.array([temperature_K, temperature_K + delta_K])
    levels = band_radiance(**ends, temperature_K=kelvins)
    return dict(zip(_LEVELS, levels.tolist(), strict=True))


def draw_radiances(
    radiances: scene_canvas.Radiances,
    canvas: scene_canvas.Canvas,
    *,
    kind: str,
    angle_deg: float,
    frequency: float,
) -> npt.NDArray[np.floating]:
    """A test scene of these radiances, averaged over each sample's area.

    The picture is linear in all radiances, and in the strengths of textures that may be among them.
    `angle_deg` is the direction, from +x towards +y, of the slanted edge's normal and of the
    sinusoid; `frequency` is in cycles across the frame's width (sine) or shorter side (coarsest
    bars), or the number of spokes.
    """
    if kind in DRAWN:
        return DRAWN[kind]().render(radiances, canvas)
    background, signal = radiances["background"], radiances["signal"]
    levels = {"background": background, "signal": signal}
    return draw_target(kind, canvas, **levels, angle_deg=angle_deg, frequency=frequency)


# In two steps: where each surface is seen, which is kept, then how bright they are.
#
# An edit of a temperature then takes a small part of the drawing's time. Scenes that are drawn as
# fast as that are drawn at once. So are large ones: their shares would take much memory, about 20
# bytes a sample in single precision, and twice the time of a picture that is looked at only once.


def in_two_steps(*, kind: str, width: int, height: int) -> bool:
    return kind in GEOMETRY and width * height <= MOST_SAMPLES


def draw_shares(kind: str, canvas: scene_canvas.Canvas, **geometry: float) -> Shares:
    """Share of each sample's area that shows each surface; `geometry` is what `GEOMETRY` names."""
    if kind in DRAWN:
        return scene_canvas.layers_of(DRAWN[kind](), canvas)
    return draw_target(kind, canvas, background=0.0, signal=1.0, **geometry)


def show_radiances(shares: Shares, radiances: scene_canvas.Radiances) -> npt.NDArray[np.floating]:
    """The picture of these radiances, as `draw_radiances`, but for rounding."""
    if isinstance(shares, scene_canvas.Layers):
        return shares.picture(radiances)
    background, signal = radiances["background"], radiances["signal"]
    picture: npt.NDArray[np.floating] = shares * (signal - background)
    picture += background
    return picture


# In bands of wavelength: each sum of bands is the scene of the surfaces' sums.


def band_edges(*, cut_on_um: float, cut_off_um: float, bands: int) -> Floats:
    """Where so many bands of equal width end, (bands + 1,) [µm]."""
    return np.linspace(cut_on_um, cut_off_um, bands + 1)


def scene_spectra(
    *,
    kind: str,
    cut_on_um: float,
    cut_off_um: float,
    bands: int,
    temperature_K: float,
    delta_K: float,
    emissivity: Emissivity,
    sun_elevation_deg: float,
    quantity: str = "radiance",
    reflectances: tuple[float, float] | None = None,
) -> dict[str, Floats]:
    """Spectra of all that a scene is made of, in so many bands of equal width.

    A texture's strength follows in every band from the radiances there. `emissivity`,
    `sun_elevation_deg` and the `quantity` reflectance are for `DRAWN`; targets have the same
    `reflectances` in all bands.
    """
    kelvins: dict[str, Any] = {"temperature_K": temperature_K, "delta_K": delta_K}
    edges = band_edges(cut_on_um=cut_on_um, cut_off_um=cut_off_um, bands=bands)
    rows: list[scene_canvas.Radiances] = []
    if kind in DRAWN:
        spectra = surface_spectra(
            edges_um=edges,
            emissivity=emissivity,
            sun_elevation_deg=sun_elevation_deg,
            reflectance=quantity == "reflectance",
            **kelvins,
        )
        textures = DRAWN[kind]().textures
        for band in range(bands):
            known = {name: float(values[band]) for name, values in spectra.items()}
            rows.append(scene_canvas.with_textures(known, textures))
    elif reflectances is not None:
        rows = [dict(zip(_LEVELS, reflectances, strict=True))] * bands
    else:
        for low, high in pairwise(edges.tolist()):
            levels = scene_radiances(kind=kind, cut_on_um=low, cut_off_um=high, **kelvins)
            rows.append({name: level / (high - low) for name, level in levels.items()})
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def weighted(spectra: Spectra, weights: tuple[float, ...]) -> scene_canvas.Radiances:
    factors = np.array(weights)
    return {name: float(values @ factors) for name, values in spectra.items()}


def shown_means(shares: Shares, spectra: Spectra) -> Floats:
    """Mean of every band of a scene whose shares are known, (bands,)."""
    if isinstance(shares, scene_canvas.Layers):
        return _of_surfaces(shares.names, shares.means, spectra)
    background = spectra["background"]
    share = float(np.mean(shares, dtype=np.float64))
    return np.asarray(background + share * (spectra["signal"] - background))


def drawn_means(
    spectra: Spectra, canvas: scene_canvas.Canvas, *, kind: str, **geometry: float
) -> Floats:
    """The same of a scene that is drawn anew, with the parameters of `draw_radiances`."""
    if kind in DRAWN:
        drawing = DRAWN[kind]()
        return _of_surfaces(drawing.names, scene_canvas.mean_shares(drawing, canvas), spectra)
    return shown_means(draw_shares(kind, canvas, **geometry), spectra)


def _of_surfaces(names: tuple[str, ...], shares: Floats, spectra: Spectra) -> Floats:
    return np.asarray(shares @ np.array([spectra[name] for name in names]))


STAR_RADIUS = 0.45
"""Radius of the star as a share of the frame's shorter side."""

BAR_GROUPS = 12
BAR_MINIMUM = 9.0
MAX_SPOKES = 1024
_WARMER = scene_canvas.difference("signal", "background")


def draw_target(
    kind: str,
    canvas: scene_canvas.Canvas,
    *,
    background: float,
    signal: float,
    angle_deg: float = 0.0,
    frequency: float = 0.0,
) -> npt.NDArray[np.floating]:
    """One of the targets; parameters as for `nodes.scenes.draw.draw_radiances`."""
    width, height = canvas.width, canvas.height
    if kind in ("two_panel", "four_bar"):
        drawing = scene_canvas.Drawing("background")
        if kind == "two_panel":
            drawing.add(_WARMER, (coverage.band(0.0, 1.0), coverage.band(0.5, 1.0)))
        else:
            _four_bar(drawing, width, height, frequency)
        return drawing.render({"background": background, "signal": signal}, canvas)
    if kind in ("point", "uniform"):
        picture = canvas.filled(lambda start, stop: np.full((stop - start, width), background))
        if kind == "point":
            picture[height // 2, width // 2] = signal
        return picture
    if kind == "siemens_star" and not (
        frequency == round(frequency) and 1 <= frequency <= MAX_SPOKES
    ):
        raise ParameterError("frequency", frequency, f"a whole number of spokes, 1 to {MAX_SPOKES}")
    # In samples from the frame's centre.
    x_edges, y_edges = (np.arange(count + 1.0) - 0.5 * count for count in (width, height))

    def rows(start: int, stop: int) -> Floats:
        edges = x_edges, y_edges[start : stop + 1]
        if kind == "sine":
            return _sine(*edges, background, signal, angle_deg, frequency / width)
        if kind == "slanted_edge":
            shares = [_slanted_edge(*edges, angle_deg)]
        else:
            shares = _siemens_star(*edges, STAR_RADIUS * min(width, height), int(frequency))
        above: Any = signal - background
        for share in shares:
            above = above * share
        return np.asarray(background + above)

    return canvas.filled(rows)


def _slanted_edge(x_edges: Floats, y_edges: Floats, angle_deg: float) -> Floats:
    """Share of the signal on one side of an edge through the centre.

    The edge's normal points `angle_deg` from +x (to the right) towards +y (down) into the
    signal, so that 0 is a vertical edge with the signal on the right.
    """
    turn = np.deg2rad(angle_deg)
    normal = {"normal_x": float(np.cos(turn)), "normal_y": float(np.sin(turn))}
    return coverage.half_plane_coverage(x_edges, y_edges, **normal, offset=0.0)


def _sine(
    x_edges: Floats,
    y_edges: Floats,
    background: float,
    signal: float,
    angle_deg: float,
    per_sample: float,
) -> Floats:
    """A sinusoid of radiance between `background` and `signal`, a crest at the centre.

    It varies along `angle_deg` from +x towards +y with so many cycles per sample,
    and every sample holds its mean over the sample: the swing falls by a sinc per axis.
    """
    turn = np.deg2rad(angle_deg)
    along_x, along_y = per_sample * float(np.cos(turn)), per_sample * float(np.sin(turn))
    swing = 0.5 * (signal - background) * float(np.sinc(along_x) * np.sinc(along_y))
    x, y = (0.5 * (edges[1:] + edges[:-1]) for edges in (x_edges, y_edges))
    across, along = 2.0 * np.pi * along_x * x, 2.0 * np.pi * along_y * y[:, None]
    picture = 0.5 * (signal + background) + np.cos(along) * (swing * np.cos(across))
    return np.asarray(picture - np.sin(along) * (swing * np.sin(across)))


def _siemens_star(x_edges: Floats, y_edges: Floats, radius: float, spokes: int) -> list[Floats]:
    """Share of a disc of `spokes` sectors, the first about the +x axis; at the rim a product."""
    disc = coverage.ellipse_coverage(
        x_edges, y_edges, centre_x=0.0, centre_y=0.0, radius_x=radius, radius_y=radius
    )
    return [disc, coverage.star_coverage(x_edges, y_edges, spokes=spokes)]


def _four_bar(drawing: scene_canvas.Drawing, width: int, height: int, frequency: float) -> None:
    """Pairs of four-bar targets, upright and level, each √2 finer than the one before.

    The coarsest has `frequency` cycles per shorter side of the frame. A bar is 7 times as long
    as wide, so that four bars and three gaps fill a square. Pairs fill the frame in rows.
    """
    if not frequency >= BAR_MINIMUM:
        allowed = f"at least {BAR_MINIMUM:g}, so that the coarsest pair of bars fits"
        raise ParameterError("frequency", frequency, allowed)
    short = min(width, height)
    unit_x, unit_y = short / width, short / height
    for left, top, bar in _bar_layout(frequency, 1.0 / unit_x, 1.0 / unit_y):
        starts = 2.0 * bar * np.arange(4)
        side = 7.0 * bar
        across = left + 9.0 * bar
        upright = coverage.steps((left + starts) * unit_x, (left + starts + bar) * unit_x)
        level = coverage.steps((top + starts) * unit_y, (top + starts + bar) * unit_y)
        drawing.add(_WARMER, (coverage.band(top * unit_y, (top + side) * unit_y), upright))
        drawing.add(_WARMER, (level, coverage.band(across * unit_x, (across + side) * unit_x)))


def _bar_layout(frequency: float, room_x: float, room_y: float) -> list[tuple[float, float, float]]:
    """Left, top and bar width of each pair, in shorter sides of the frame."""
    places: list[tuple[float, float, float]] = []
    left = top = shelf = widest = 0.0
    for group in range(BAR_GROUPS):
        bar = 0.5 / (frequency * 2.0 ** (0.5 * group))
        if left + 16.0 * bar > room_x - 0.1 and shelf > 0.0:
            left, top, shelf = 0.0, top + shelf, 0.0
        if top + 7.0 * bar > room_y - 0.1:
            break
        places.append((left, top, bar))
        widest = max(widest, left + 16.0 * bar)
        left += 18.5 * bar
        shelf = max(shelf, 9.5 * bar)
    low = max(top + 7.0 * bar for _, top, bar in places)
    aside, above = 0.5 * (room_x - widest), 0.5 * (room_y - low)
    return [(left + aside, top + above, bar) for left, top, bar in places]
