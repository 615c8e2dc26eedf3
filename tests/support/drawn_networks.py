"""Random modules in random order as a network file, with the frames it reads."""

import math
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any

import numpy as np

from core.network.network import Link, Network, Node
from drawn_modules import Item, Modules, Params, Sampling, short

ON_SPECTRUM = (
    "atmosphere_mtf", "exit_pupil_mtf", "gaussian_mtf", "crosstrack_mtf", "alongtrack_mtf",
    "relative_motion_mtf", "jitter_mtf", "vibration_mtf", "detector_mtf", "charge_eff_mtf",
    "charge_eff_phase",
)  # fmt: skip
RESAMPLING = ("combine_pixels", "sample_pixels", "interpolate", "anti_alias")
OF_1996 = (*RESAMPLING, "periodic_noise", "noise_file", "electronics_noise")
CAMERA = ("focal_plane", "microbolometer", "nuc", "noise_3d_source")
OF_TODAY = (*RESAMPLING, *CAMERA, *CAMERA)
"""A camera's noises are drawn: such a network is looked at without them, and has no other."""
ON_PICTURE = (*OF_1996, *CAMERA)
WITH_CONTEXT = ("electronics_noise", "focal_plane", "microbolometer")
SMALL = [
    (1, 1), (1, 2), (2, 1), (1, 7), (9, 1), (1, 16), (2, 2), (3, 2), (2, 5), (5, 4), (7, 5), (4, 8),
    (8, 6), (6, 11), (9, 9), (12, 10), (13, 7), (11, 13), (16, 13), (15, 16),
]  # fmt: skip
LARGE = [(130, 262), (257, 131), (1, 1201), (1200, 3), (300, 310), (512, 520)]
Names = dict[Any, list[str]]
KINDS = ("scene", "scene", "constant", "wide", "signed", "point")


def frame(kind: str, rows: int, columns: int, seed: int) -> np.ndarray:
    """A frame whose samples are the same in single precision."""
    random = np.random.default_rng((seed, rows, columns))
    point = np.zeros((rows, columns))
    point[random.integers(rows), random.integers(columns)] = 50.0
    drawn = {
        "scene": random.uniform(20, 60, (rows, columns)),
        "constant": np.full((rows, columns), 37.25),
        "wide": 10 ** random.uniform(-3, 3, (rows, columns)),
        "signed": random.uniform(-15, 15, (rows, columns)),
        "point": point,
    }[kind]
    return drawn.astype(np.float32).astype(float)


def frames(folder: Path, sizes: list[tuple[int, int]]) -> tuple[dict[str, np.ndarray], Names]:
    """Frames and pupils by the names of their files in `folder`, and these names by size."""
    found = {
        f"{kind}{number}_{rows}x{columns}.npy": frame(kind, rows, columns, number)
        for rows, columns in sizes
        for number, kind in enumerate(KINDS)
    }
    names: Names = {
        size: [n for n in found if n.endswith("_{}x{}.npy".format(*size))] for size in sizes
    }
    random = np.random.default_rng(8)
    names["pupil", 0] = ["pupil0.npy", "pupil1.npy"]
    for name in names["pupil", 0]:
        pupil = np.hypot(*np.mgrid[-4:4:8j, -4.5:4.5:9j]) <= 4
        # A transmission of its own for each sample, one of them 1.
        found[name] = pupil * random.integers(1, 65, pupil.shape) / 64
    for name, samples in found.items():
        np.save(folder / name, samples)
    return found, names


@dataclass(frozen=True)
class Drawn:
    """What a network is made of; `document` puts it together, whatever is left out of it.

    The first spectrum's phase may be of an `other` file, or of the same by an Init & Trans of its
    own.
    """

    first: tuple[str, Params]
    other: str | None
    inits: tuple[Params, ...]
    items: tuple[Item, ...]

    def document(self) -> dict[str, Any]:
        return _Chain(self).built()

    def network(self) -> Network:
        return network_of(self.document())


def network_of(document: dict[str, Any]) -> Network:
    nodes = {
        name: Node(name, node["module"], node["params"], disabled="disabled" in node)
        for name, node in document["nodes"].items()
    }
    return Network(nodes=nodes, links=tuple(Link.between(*link) for link in document["links"]))


def drawn(random: Random, names: Names, most: int = 7) -> Drawn:
    """A network of up to `most` modules."""
    size = random.choice([size for size in names if size[0] != "pupil"])
    rows, columns = size
    modules = Modules(random, names)
    x = short(modules.log(-1.3, 0.7) * min(1, 100 / columns))
    y = short(x * random.choice((1, 1, modules.log(-0.3, 0.3))) * min(1, 100 / rows))
    read: Params = {
        "fov_x_deg": float(np.degrees(x * columns / 1000)),
        "fov_y_deg": float(np.degrees(y * rows / 1000)),
    }
    if random.random() < 0.1:
        read["scale"] = modules.signed(-3, 3)
    at = Sampling(rows, columns, x, y)
    items: list[Item] = []
    of_picture = OF_TODAY if random.random() < 0.3 else OF_1996
    for _ in range(random.randint(0, most)):
        key = random.choice(ON_SPECTRUM if random.random() < 0.7 else of_picture)
        counting = [item for item in items if item.key == "focal_plane" and not item.disabled]
        if key == "focal_plane" and counting:
            key = "sample_pixels"  # digital numbers are no radiance
        if key == "nuc" and not counting:
            key = "focal_plane"  # references need the band that it gives
        item = modules.item(key, at)
        items.append(item)
        at = after(item, at)
    # The phase of an OTF that is nothing is known only as long as its own modulus goes along.
    apart = not any(aberrated(item) for item in items)
    path, other = random.choice(names[size]), None
    if random.random() < 0.06 and apart:
        other = random.choice([name for name in names[size] if name.startswith("scene")])
    if random.random() < 0.03 and apart and items:
        item = random.choice(items)
        if item.key in ON_SPECTRUM:
            item.params["apply"] = "filter_only"
    inits = [init(modules, x) for _ in range(4)]
    if other:
        modules.maybe(inits[-1], "fov_x_deg", short(read["fov_x_deg"] * random.uniform(0.5, 2)))
    return Drawn((path, read), other, tuple(inits), tuple(items))


def aberrated(item: Item) -> bool:
    return bool(item.pupil.get("defocus_waves") or item.pupil.get("zernike_waves"))


def after(item: Item, at: Sampling) -> Sampling:
    """The picture's sampling behind a module."""
    p, rows, columns = item.params, at.rows, at.columns
    if item.disabled:
        return at
    if item.key == "combine_pixels":
        rows, columns = rows // p["factor_y"], columns // p["factor_x"]
        return Sampling(rows, columns, at.interval_x * p["factor_x"], at.interval_y * p["factor_y"])
    if item.key == "sample_pixels":
        x, y = p["factor_x"], p["factor_y"]
        new = math.floor(rows / y + 1e-6), math.floor(columns / x + 1e-6)
        return Sampling(*new, at.interval_x * x, at.interval_y * y)
    if item.key == "interpolate":
        new = p.get("height", rows), p.get("width", columns)
        return Sampling(*new, at.interval_x * columns / new[1], at.interval_y * rows / new[0])
    return at


def init(modules: Modules, interval: float) -> Params:
    """What Init & Trans says of a sensor whose detectors are about as large as the samples."""
    params: Params = {
        "detector_x_um": modules.log(1, 2), "detector_y_um": modules.log(1, 2),
        "focal_length_mm": short(30 / interval), "f_number": 2.0, "range_m": modules.log(2, 4),
        "velocity_m_per_s": modules.signed(0, 2), "scan_velocity_mrad_per_s": 100.0,
        "edges": modules.random.choice(("reflect", "periodic")),
    }  # fmt: skip
    modules.maybe(params, "fill_x", modules.log(-1, 0))
    modules.maybe(params, "fov_x_deg", modules.log(-1, 1), 0.05)
    return params


class _Chain:
    """Puts nodes after one another, with Init & Trans and Back Transform where they are needed."""

    def __init__(self, drawn: Drawn) -> None:
        self.drawn = drawn
        self.nodes: dict[str, dict[str, Any]] = {}
        self.links: list[list[str]] = []
        self.image, self.context, self.wires = "file.image", "", dict[str, str]()
        self.phase_context = ""

    def built(self) -> dict[str, Any]:
        path, read = self.drawn.first
        self.node("file", "read_image", {"path": path, **read})
        for number, item in enumerate(self.drawn.items):
            name = f"{number} {item.key}"
            (self.on_spectrum if item.key in ON_SPECTRUM else self.on_picture)(name, item)
        if not self.nodes.keys() - {"file"}:
            self.open()
        self.close()
        return {"nodes": self.nodes, "links": self.links, "last": self.image}

    def node(self, name: str, module: str, params: Params, *, disabled: bool = False) -> None:
        self.nodes[name] = {"module": module, "params": params}
        if disabled:
            self.nodes[name]["disabled"] = True

    def link(self, start: str, end: str) -> None:
        self.links.append([start, end])

    def open(self) -> None:
        """Begin a spectrum; the first one may take its phase from another picture."""
        count = sum(name.startswith("init") for name in self.nodes)
        name, params = f"init {count}", self.drawn.inits[count % len(self.drawn.inits)]
        self.node(name, "init_trans", params)
        self.link(self.image, f"{name}.image")
        self.context = self.phase_context = f"{name}.context"
        self.wires = {"magnitude": f"{name}.magnitude", "phase": f"{name}.phase"}
        if self.drawn.other and self.image == "file.image" and "init other" not in self.nodes:
            path, read = self.drawn.first
            same = path == self.drawn.other
            if not same:
                self.node("other", "read_image", {**read, "path": self.drawn.other})
            self.node("init other", "init_trans", self.drawn.inits[-1])
            self.link("file.image" if same else "other.image", "init other.image")
            self.wires["phase"] = "init other.phase"
            self.phase_context = "init other.context"

    def close(self) -> None:
        if not self.wires:
            return
        name = f"back {sum(node.startswith('back') for node in self.nodes)}"
        self.node(name, "back_transform", {})
        for wire, source in self.wires.items():
            self.link(source, f"{name}.{wire}")
        self.image, self.wires = f"{name}.image", {}

    def on_spectrum(self, name: str, item: Item) -> None:
        if not self.wires:
            self.open()
        self.node(name, item.key, item.params, disabled=item.disabled)
        changed = {"charge_eff_phase": ("phase",), "exit_pupil_mtf": ("magnitude", "phase")}
        wires = changed.get(item.key, ("magnitude",))
        self.link(self.phase_context if wires == ("phase",) else self.context, f"{name}.context")
        if item.pupil:
            pupil = {
                k: v
                for k, v in item.pupil.items()
                if item.pupil["shape"] != "file" or not k.startswith("size")
            }
            self.node(f"{name} pupil", "exit_pupil", pupil)
            self.link(f"{name} pupil.pupil", f"{name}.pupil")
        for wire in wires:
            self.link(self.wires[wire], f"{name}.{wire}")
            self.wires[wire] = f"{name}.{wire}"

    def on_picture(self, name: str, item: Item) -> None:
        self.close()
        if item.key in WITH_CONTEXT and not self.context:
            self.open()
            self.wires = {}
        self.node(name, item.key, item.params, disabled=item.disabled)
        self.link(self.image, f"{name}.image")
        if item.key in WITH_CONTEXT:
            self.link(self.context, f"{name}.context")
        self.image = f"{name}.image"
