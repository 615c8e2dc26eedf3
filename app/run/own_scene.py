"""A picture of one's own in the place of a network's scene: an edit from network to network."""

import math
from collections.abc import Iterable, Mapping, Sequence
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np

from app.run.transfer_chain import delivering
from core.arrays import Array
from core.chain.engine import Engine, Plan
from core.chain.wires import Image
from core.editing.operations import fresh_name
from core.errors import DataError, FileError, UsageError, close, shown
from core.evaluation.recipes import Step, ends_lineage
from core.evaluation.work import Policy, Work
from core.modules.declaration import Library, declaration
from core.network.linked_values import naming
from core.network.network import Link, Network, Node, reached
from core.physics.radiometry.radiance_units import RadianceUnit, radiance_unit
from core.records import dataclass, replace
from nodes.files import envi, formats, picture_info
from nodes.input_output import read_image, sample_unit, source_file
from nodes.shared.context_defaults import is_radiance, is_temperature

READ_IMAGE = "read_image"
RELATIVE = "relative"
EIGHT_BITS = 0.0, 255.0
_MOST_SAMPLES = 1 << 27  # of which the range is looked for
_UNITS = {"c": "°C", "celsius": "°C", "f": "°F", "degf": "°F", "fahrenheit": "°F", "k": "K"}
_REFLECTANCE = ("reflectance", "albedo", "%", "1")
_LOWER = (RELATIVE, "reflectance", "albedo")
_KNOWN = (
    "a unit of radiance (W/m²/sr, uW/cm^2/sr/um, …), a temperature (K, C, F, mK), "
    f"reflectance, %, or {RELATIVE} (scaled to the range of the original scene)"
)
Pair = tuple[float, float]


@dataclass(frozen=True)
class OwnScene:
    """A picture, and what its owner says of it; what is None follows from file and network."""

    picture: Path | Array  # of an array (rows, columns), or (rows, columns, 3) in colour
    fov_deg: Pair | None = None  # field of view across and along, degrees
    range_m: float | None = None  # distance of the scene, m
    sample_m: float | None = None  # size of a sample on the scene, m
    band_um: Pair | None = None  # shortest and longest wavelength, µm
    unit: str = ""  # of radiance, a temperature, a reflectance, or `RELATIVE`
    option: str = ""  # what stands before the names of these in messages
    hints: bool = True  # whether the lines name what says otherwise

    def plain(self) -> "OwnScene":
        """With Python's own numbers, whatever a script gives."""
        made: dict[str, Any] = {}
        for name, count in (("range_m", 1), ("sample_m", 1), ("fov_deg", 2), ("band_um", 2)):
            given = getattr(self, name)
            several = isinstance(given, Sequence | np.ndarray)
            values = list(given) if several and count > 1 else [given]
            if given is None:
                continue
            if len(values) != count or not all(isinstance(each, Real) for each in values):
                what = "a number" if count == 1 else "two numbers"
                raise UsageError(f"{name} = {given!r:.60} is not allowed: must be {what}")
            made[name] = float(given) if count == 1 else tuple(map(float, values))
        if not isinstance(self.unit, str):
            raise UsageError(f"unit = {self.unit!r:.60} is not allowed: must be text")
        return replace(self, **made)

    def check(self) -> None:
        allowed = "above 0° and below 180°"
        for value in self.fov_deg or ():
            if not 0.0 < value < 180.0:
                raise UsageError(
                    f"{self.named('fov_deg')} {value:g} is not allowed: must be {allowed}"
                )
        for name, length in (("range_m", self.range_m), ("sample_m", self.sample_m)):
            if length is not None and not 0.0 < length < math.inf:
                raise UsageError(
                    f"{self.named(name)} {length:g} is not allowed: must be a length above 0 m"
                )
        if self.band_um is not None and not 0.0 < self.band_um[0] < self.band_um[1] < 1e6:
            low, high = self.band_um
            what = "must be two wavelengths above 0 µm, the shorter first"
            raise UsageError(f"{self.named('band_um')} {low:g} {high:g} is not allowed: {what}")
        if self.fov_deg is not None and self.sample_m is not None:
            names = f"{self.named('fov_deg')} and {self.named('sample_m')}"
            raise UsageError(f"{names} both set the field of view: give only one of them")

    def named(self, name: str) -> str:
        return f"{self.option}{name.replace('_', '-') if self.option else name}"


@dataclass(frozen=True)
class SceneReplaced:
    network: Network  # the network
    node: str  # the node that reads the picture
    lines: tuple[str, ...]  # how the picture was taken: samples, field of view, band
    samples: source_file.HeldSamples | None = None  # those of an array
    ends: Pair | None = None  # what lowest and highest became, if scaled


def scene_nodes(network: Network, library: Library) -> list[str]:
    """The nodes that picture a scene: without an input, and with an image."""
    return [
        name
        for name, node in network.nodes.items()
        if node.module in library
        and not (declared := declaration(library[node.module])).inputs
        and any("image" in port.types for port in declared.outputs)
    ]


def with_own_scene(
    network: Network,
    own: OwnScene,
    *,
    library: Library,
    plan: Plan,
    node: str | None = None,
    stored: str | None = None,
    engine: Engine | None = None,
) -> SceneReplaced:
    """The network with a picture in the place of its scene; wires and layout stay.

    `stored` is the file's name in the network. An `engine` keeps the range of the original scene.
    """
    own = own.plain()
    own.check()
    name = _chosen(network, library, node, own.option)
    return _Replacing(network, own, name, plan, engine or Engine(library)).done(stored)


def _chosen(network: Network, library: Library, node: str | None, option: str) -> str:
    scenes = scene_nodes(network, library)
    if node is not None:
        if node not in scenes:
            hint = close(node, scenes) or f"; its scenes: {', '.join(scenes) or 'none'}"
            raise UsageError(f"{shown(node)} is not a scene of the network{hint}")
        return node
    seen = [name for name in scenes if name in delivering(network, library)]
    if len(seen) == 1:
        return seen[0]
    if not seen:
        raise UsageError("the network has no scene that a picture could replace")
    which = f"{option[:-1]} {seen[0]}=FILE" if option else f"node={seen[0]!r}"
    names = ", ".join(map(shown, seen))
    raise UsageError(f"the network has {len(seen)} scenes, {names}: name one scene, as in {which}")


class _Replacing:
    def __init__(
        self, network: Network, own: OwnScene, name: str, plan: Plan, engine: Engine
    ) -> None:
        self._network, self._own, self._name, self._plan = network, own, name, plan
        self._engine, self._library = engine, engine.library
        self._ends: Pair | None = None
        self._lines: list[str] = []
        self._where: list[str] = []  # field of view, distance, band
        self._kind = "samples"
        self._held: source_file.HeldSamples | None = None
        if isinstance(own.picture, np.ndarray):
            self._held = source_file.HeldSamples.of(grey(own.picture))
            self._info = self._held.info
        else:
            self._info = _info(own.picture)
        outputs = plan.nodes[name].outputs.values()
        self._before: Image | None = next((o for o in outputs if isinstance(o, Image)), None)
        self._after = reached(plan.network.followers, plan.network.followers.get(name, ()))
        self._converter = ""

    def done(self, stored: str | None) -> SceneReplaced:
        info = self._info
        values: dict[str, Any] = {}
        if self._held is None:
            values["path"] = stored or str(info.path.absolute())
        values |= self._of_cube() if sample_unit.is_spectral(info) else self._of_picture()
        network = self._without_references()
        fields, network = self._geometry(network)
        values |= fields
        old = network.nodes[self._name]
        title = declaration(self._library[old.module]).title
        node = Node(old.id, READ_IMAGE, values, auto=old.auto, noise=old.noise, final=old.final)
        network = self._wired(network.with_node(node))
        what = info.path.name if self._held is None else "an array"
        head = f"{what}, {info.columns} × {info.rows} {self._kind}, replaces {title}"
        said = filter(None, (head, *self._lines, ", ".join(self._where)))
        return SceneReplaced(network, self._name, tuple(said), self._held, self._ends)

    # Samples

    def _of_cube(self) -> dict[str, Any]:
        """Bands of wavelength: each by itself where the network's scene has bands, else summed."""
        info, own, before = self._info, self._own, self._before
        unit = _worded(own.unit)
        if not (unit or info.unit):
            raise UsageError(
                f"{info.path}: the file does not give the unit of its bands. Give "
                f"{self._own.named('unit')}, such as W/m²/sr/µm"
            )
        if unit == RELATIVE:
            raise UsageError(
                f"{self._own.named('unit')} {RELATIVE}: not allowed for a cube; give a unit such "
                "as W/m²/sr/µm"
            )
        first, last = envi.band_ends_um(info)
        ends = float(min(first)), float(max(last))
        wanted = own.band_um or (None if before is None else before.band_um) or ends
        low, high = max(wanted[0], ends[0]), min(wanted[1], ends[1])
        if low >= high:
            raise UsageError(
                f"{info.path}: the bands of the file, {_um(ends)}, do not overlap {_um(wanted)}. "
                f"Give {self._own.named('band_um')}, or use a network for the file's band"
            )
        kept = before is not None and before.bands is not None
        how = "kept separate" if kept else "summed"
        share = envi.coverage(info, wanted)
        part = "" if (low, high) == wanted else f", {100 * share:.0f} % of {_um(wanted)}"
        outside = self._outside((low, high))
        self._lines.append(f"{info.bands} bands, {how}, {_um((low, high))}{part}{outside}")
        self._converter = self._conversion(unit or info.unit or "")
        values: dict[str, Any] = {"cut_on_um": low, "cut_off_um": high}
        if kept or self._converter:
            values["bands"] = "all"
        return values | ({"unit": unit} if unit else {})

    def _of_picture(self) -> dict[str, Any]:
        """One band of samples: as its unit says, else scaled to the range of the scene before."""
        info, own, before = self._info, self._own, self._before
        values: dict[str, Any] = {}
        if info.rgb:
            values["bands"] = "luminance"
            self._kind = "samples, from the luminance of the colours"
        elif info.bands > 1:
            self._kind = f"samples, the first of {info.bands} channels (band = 0)"
        unit, stated = _worded(own.unit) or _worded(info.unit or ""), bool(own.unit)
        band = (
            own.band_um
            or read_image.header_band(info, 0)
            or (None if before is None else before.band_um)
        )
        if band is not None:
            values |= {"cut_on_um": band[0], "cut_off_um": band[1]}
            found = (
                " from the file's header"
                if read_image.header_band(info, 0)
                else " as in the original scene"
            )
            whose = "" if own.band_um else found
            self._where.append(f"band {_um(band)}{whose}{self._outside(band)}")
        radiance = _radiance(unit)
        same = bool(unit) and before is not None and unit == before.unit
        if before is not None and {unit, before.unit} <= {*_REFLECTANCE}:
            same = True  # the network lights it already
        if radiance is None and not same and not self._conversion(unit):
            if stated and unit != RELATIVE:
                raise UsageError(
                    f"{self._own.named('unit')} {shown(own.unit)} is not allowed: must be {_KNOWN}"
                )
            return values | self._relative(unit)
        if radiance is not None and radiance.spectral:
            if band is None:
                raise UsageError(
                    f"{unit} needs {self._own.named('band_um')}, the band to integrate over"
                )
            scale = radiance.factor * (band[1] - band[0])
            values |= {"scale": scale, "unit": "W/m²/sr"}
            self._lines.append(f"samples in {unit}, multiplied by the width of the band")
            return values
        self._converter = self._conversion(unit)
        largest = np.iinfo(info.dtype).max if np.dtype(info.dtype).kind == "u" else 1
        if unit == "reflectance" and largest > 1:
            values["scale"] = 1.0 / largest
            self._lines.append(f"samples 0…{largest} map to reflectances 0…1")
        else:
            self._lines.append(f"samples in {unit}{'' if stated else ', from the file'}")
        return values | {"unit": unit}

    def _outside(self, band: Pair) -> str:
        scene_um = None if self._before is None else self._before.band_um
        if scene_um is None or (band[0] < scene_um[1] and scene_um[0] < band[1]):
            return ""
        return f", outside the original scene's band, {_um(scene_um)}"

    def _relative(self, unit: str) -> dict[str, Any]:
        """Scaled so that the range of the samples becomes that of the scene before."""
        before = self._before
        if before is None:
            reason = self._plan.nodes[self._name].error
            raise UsageError(
                f"{self._info.path}: the file gives no unit, and the network's original scene "
                f"cannot be read ({reason}), so the samples cannot be scaled to its range. Give "
                f"{self._own.named('unit')}"
            )
        if before.rows * before.columns > _MOST_SAMPLES:
            raise self._refusal()
        low, high = self._engine.work(Policy("single")).value(Step.of(_ends_of, before.recipe))
        if not (math.isfinite(low) and math.isfinite(high)):
            raise self._refusal()
        if low == high:  # a uniform scene: half as much above as below
            low, high = sorted((0.5 * low, 1.5 * low)) if low else (0.0, 1.0)
        self._ends = low, high
        first, last, what = self._levels()
        scaled = fitted((first, last), self._ends)
        of_unit = f" in {unit}" if unit and unit != RELATIVE else ""
        self._lines.append(
            f"{what} {first:.5g}…{last:.5g}{of_unit} scaled to {low:.4g}…{high:.4g} {before.unit}, "
            f"the range of the original scene{self._hint('unit', 'sets the unit')}"
        )
        return {**scaled, "unit": before.unit}

    def _levels(self) -> tuple[float, float, str]:
        info = self._info
        array = self._own.picture
        dtype = array.dtype if isinstance(array, np.ndarray) else np.dtype(info.dtype)
        if dtype == np.uint8:
            return *EIGHT_BITS, "8-bit samples"
        if info.rows * info.columns > _MOST_SAMPLES:
            raise self._refusal()
        if self._held is not None:
            samples: Array = self._held.samples
        elif info.rgb:
            samples = source_file.luminance(info.path, info.rgb)
        else:
            samples = formats.read_pixels(info.path)
        first, last = sample_ends(samples)
        if not (math.isfinite(first) and math.isfinite(last)):
            raise self._refusal()
        return first, last, "samples"

    def _refusal(self) -> UsageError:
        return UsageError(
            f"{self._info.path}: the file gives no unit, and its samples are too large or not "
            "finite, so they cannot be scaled to the range of the network's original scene. Give "
            f"{self._own.named('unit')}"
        )

    def _conversion(self, unit: str) -> str:
        """The module that makes radiance of that unit where the network takes radiance."""
        if self._before is not None and not is_radiance(self._before.unit):
            return ""
        if is_temperature(unit):
            return "to_radiance"
        return "reflected_light" if unit.lower() in _REFLECTANCE else ""

    # Geometry

    def _geometry(self, network: Network) -> tuple[dict[str, Any], Network]:
        """Field of view and distance: values of the picture, and changes of the nodes after it."""
        own, info = self._own, self._info
        network = self._at_range(network)
        ground = next((n for n in network.nodes if self._value(n, "ground_interval_m")), None)
        if ground is not None and own.fov_deg is None:
            return {}, self._on_ground(network, ground)
        angle = self._fov_deg()
        if angle is None:
            return {}, network
        if ground is not None:
            network = _with(network, ground, ground_interval_m=None, ground_interval_y_m=None)
        for name in network.nodes:
            if name in self._after and network.nodes[name].module == "init_trans":
                network = _with(network, name, fov_x_deg=None, fov_y_deg=None)
        if own.fov_deg is None and angle == (info.fov_x_deg, info.fov_y_deg):
            return {}, network
        return {"fov_x_deg": angle[0], "fov_y_deg": angle[1]}, network

    def _fov_deg(self) -> Pair | None:
        """Field of view: as given, by the distance, of the file, else as wide as before."""
        own, info = self._own, self._info
        wide, high = info.columns, info.rows
        if own.fov_deg is not None:
            self._where.append(f"field of view {_deg(own.fov_deg)}")
            return own.fov_deg
        if own.sample_m is not None:
            known = [at for name in self._after if (at := self._value(name, "range_m"))]
            if (distance := own.range_m or max(known, default=None)) is None:
                raise UsageError(
                    f"{self._own.named('sample_m')} needs {self._own.named('range_m')}"
                )
            step = math.degrees(own.sample_m / distance)
            angle = step * wide, step * high
            if max(angle) >= 180.0:
                raise UsageError(
                    f"{self._own.named('sample_m')} {own.sample_m:g}: {_deg(angle)} at "
                    f"{distance:g} m is not a possible field of view; allowed: below 180°"
                )
            self._where.append(f"field of view {_deg(angle)}, samples of {own.sample_m:g} m at "
                               f"{distance:g} m")  # fmt: skip
            return angle
        if info.fov_x_deg and info.fov_y_deg:
            self._where.append(f"field of view {_deg((info.fov_x_deg, info.fov_y_deg))}, from "
                               "the file's header")  # fmt: skip
            return info.fov_x_deg, info.fov_y_deg
        before = self._fov_before()
        if before is None:
            return None
        step = min(before[0] / wide, before[1] / high)
        angle = step * wide, step * high
        side = "as wide" if math.isclose(angle[0], before[0]) else "as high"
        hint = self._hint("fov_deg", "sets another")
        self._where.append(f"field of view {_deg(angle)}, {side} as the original scene{hint}")
        return angle

    def _fov_before(self) -> Pair | None:
        before = self._before
        if before is None:
            return None
        grids: list[Any] = [before]
        for name in self._plan.network.order():
            if name in self._after:
                planned = self._plan.nodes[name]
                grids += [o for o in planned.outputs.values() if isinstance(o, Image)]
                grids += [g for o in planned.outputs.values() if (g := getattr(o, "grid", None))]
        for one in grids:
            shape = getattr(one, "rows", 0), getattr(one, "columns", 0)
            x, y = getattr(one, "interval_x_mrad", None), getattr(one, "interval_y_mrad", None)
            if shape == before.shape and x and y:
                return math.degrees(x * shape[1] / 1e3), math.degrees(y * shape[0] / 1e3)
        return None

    def _at_range(self, network: Network) -> Network:
        distance = self._own.range_m
        if distance is None:
            return network
        kinds = {n: network.nodes[n].module for n in network.nodes if n in self._after}
        cameras = [name for name, kind in kinds.items() if kind == "camera"]
        first = cameras or [name for name, kind in kinds.items() if kind == "init_trans"]
        others = [name for name in kinds if name not in first and self._value(name, "range_m")]
        taking = [*first, *others]
        for name in taking:
            network = _with(network, name, range_m=distance)
        where = f" (range_m of {', '.join(taking)})" if taking else ": no node uses this distance"
        self._where.append(f"distance {distance:g} m{where}")
        return network

    def _on_ground(self, network: Network, name: str) -> Network:
        interval = self._own.sample_m
        if interval is None:
            if self._before is None:
                return network
            x = self._value(name, "ground_interval_m")
            y = self._value(name, "ground_interval_y_m") or x
            across = x * self._before.columns / self._info.columns
            interval = max(across, y * self._before.rows / self._info.rows)
        self._lines.append(
            f"samples of {interval:.4g} m on the ground"
            f"{'' if self._own.sample_m else ', covering as much ground as the original scene'} "
            f"({name}.ground_interval_m)"
        )
        return _with(network, name, ground_interval_m=interval, ground_interval_y_m=None)

    def _value(self, name: str, parameter: str) -> Any:
        planned = self._plan.nodes.get(name) if name in self._after else None
        return None if planned is None else getattr(planned.module, parameter, None)

    # The network

    def _wired(self, network: Network) -> Network:
        name, source = self._name, self._name
        nodes, layout = dict(network.nodes), dict(network.layout)
        links = list(network.links)
        if self._converter:
            source = fresh_name(self._converter, nodes)
            places = list(nodes)
            places.insert(places.index(name) + 1, source)
            nodes[source] = Node(source, self._converter)
            nodes = {place: nodes[place] for place in places}
            if name in layout:
                layout[source] = (layout[name][0], layout[name][1] + 160.0)
            title = declaration(self._library[self._converter]).title
            self._lines.append(f"{title} ({source}) converts the scene to radiance")
        ours = {"source": source, "output": "image"}
        links = [replace(link, **ours) if link.source == name else link for link in links]
        if source != name:
            links.append(Link(name, "image", source, "image"))
        return replace(network, nodes=nodes, links=tuple(links), layout=layout)

    def _without_references(self) -> Network:
        """With values in the place of expressions that follow the scene before."""
        network = self._network
        for name, parameter in naming(network, {self._name}):
            planned = self._plan.nodes.get(name)
            value = None if planned is None else planned.node.params.get(parameter)
            if value is not None and not isinstance(value, Mapping):
                network = network.with_parameter(name, parameter, value)
                self._lines.append(
                    f"{name}.{parameter} is now fixed at {value}: it was linked to the original "
                    "scene"
                )
        return network

    def _hint(self, name: str, does: str) -> str:
        return f" ({self._own.named(name)} {does})" if self._own.hints else ""


def _with(network: Network, name: str, **values: Any) -> Network:
    node = network.nodes[name]
    params = {**node.params, **values}
    kept = {key: value for key, value in params.items() if value is not None or key not in values}
    return network.with_node(replace(node, params=kept))


def _info(path: Path) -> picture_info.PictureInfo:
    info = formats.read_info(path)
    if min(info.rows, info.columns) < 2:
        raise FileError(
            f"{path}: {info.columns} × {info.rows} samples; a scene needs at least 2 × 2"
        )
    return info


def grey(array: Array) -> Array:
    """An array of two dimensions; of red, green and blue their luminance."""
    if array.ndim == 3 and array.shape[-1] in (3, 4):
        return np.asarray(array[..., :3] @ np.array(source_file.LUMINANCE))
    if array.ndim == 0:
        raise DataError(
            f"{array.item()!r:.80} is not a picture: give a file or an array (rows, columns)"
        )
    if array.ndim != 2:
        shape = " × ".join(map(str, array.shape))
        raise DataError(
            f"an array of shape {shape} is not a picture: give (rows, columns), or "
            "(rows, columns, 3)"
        )
    return array


def _radiance(unit: str) -> RadianceUnit | None:
    """The unit of radiance in watts that a text names, of a band or per µm; None for all others."""
    try:
        known = None if unit == RELATIVE else radiance_unit(unit)
    except DataError as error:
        raise UsageError(error.message) from error
    return None if known is None or known.photons or known.spectral == "cm⁻¹" else known


def _worded(unit: str) -> str:
    text = unit.strip()
    return text.lower() if text.lower() in _LOWER else _UNITS.get(text.lower(), text)


def fitted(levels: Pair, ends: Pair) -> dict[str, float]:
    """Scale and offset of Read Image by which levels become the ends of a range."""
    (first, last), (low, high) = levels, ends
    if first == last:
        return {"scale": 1.0, "offset": 0.5 * (low + high) - first}
    scale = (high - low) / (last - first)
    return {"scale": scale, "offset": low - scale * first}


def sample_ends(samples: Array) -> Pair:
    return float(np.nanmin(samples)), float(np.nanmax(samples))


@ends_lineage
def _ends_of(_: Work, samples: Array) -> Pair:
    return sample_ends(samples)


def _deg(angle: Iterable[float]) -> str:
    return " × ".join(f"{value:.4g}" for value in angle) + "°"


def _um(band: Pair) -> str:
    return f"{band[0]:g} to {band[1]:g} µm"
