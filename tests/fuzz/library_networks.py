"""Random networks of the library's modules: wired by port types, tiny, with values of any size."""

import math
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
from mending import mended

from battery_settings import EXAMPLES, SENSOR, SETTINGS, SMALL_PUPIL
from core.modules.declaration import Declaration, Port, declaration
from core.modules.parameters import Parameter
from nodes.library import standard_library

Document = dict[str, Any]
MAKERS = {
    "image": ("test_scene", "read_image"),
    "context": ("init_trans",),
    "magnitude": ("init_trans",),
    "phase": ("init_trans",),
    "pupil": ("exit_pupil",),
    "transfer": ("gaussian_mtf", "jitter_mtf", "detector_mtf"),
    "curve": ("mtf_slices",),
    "table": ("examine_image",),
}
LARGEST_SIDE = 64
SIDES = (1, 2, 3, 5, 8, 13, 16, 16, 24, 29, 32, 48, 61, LARGEST_SIDE)
LARGE_SIDES = (127, 211, 256, 384, 509)  # of 2 of 100 networks: what is done in blocks of rows
# What sizes an array or a loop: values for people, not the largest ones allowed.
SIZES = {
    "width", "height", "size_x", "size_y", "columns", "rows", "frames", "wavelengths", "nodes",
    "half_width_px", "strips", "samples", "bins",
}  # fmt: skip
UNITS = ("W/m²/sr", "W/m^2/sr/um", "K", "counts", "", "furlong", "µW/cm²/sr", "$\\frac{$", "1e3 W")
EXTREME = (5e-324, 1e-300, 1e-30, 1e30, 1e150, 1.7e308)


class Network:
    """A network file being drawn, with the frames it reads written into its folder."""

    def __init__(self, random: Random, folder: Path) -> None:
        self.random = random
        self.folder = folder
        self.nodes: Document = {}
        self.links: list[list[str]] = []
        self.ports: dict[str, list[str]] = {}
        # Of most networks none: a single one often makes the whole network refused.
        self.extremes = 0.05 if random.random() < 0.15 else 0.0
        self.side = random.choice(SIDES)
        self.size = self._size()
        self.files = [self._frame(number) for number in range(random.randint(1, 2))]

    def document(self) -> Document:
        """The network file of one or two pictures and up to a dozen modules."""
        random = self.random
        self._need("image")
        if random.random() < 0.9:
            self._need("phase")
        if random.random() < 0.25:
            self.add(random.choice(MAKERS["image"]))
            if random.random() < 0.5:
                self.add("init_trans")
        keys = list(standard_library())
        for _ in range(random.randint(0, 12)):
            self.add(random.choice(keys))
            if random.random() < 0.2:
                self.add("back_transform")
        document: Document = {
            "format": "imagechain-network",
            "version": 1,
            "name": random.choice(("Drawn", "", "ß €", "$a_b$ <b>", "a/b", "x" * 300)),
            "seed": random.choice((0, 1, random.getrandbits(63))),
            "nodes": self.nodes,
            "links": self.links,
        }
        if random.random() < 0.2 and self.ports.get("image"):
            document["final"] = random.choice(self.ports["image"])
        if random.random() < 0.1:
            document["layout"] = {name: [random.uniform(-9, 9), 0] for name in self.nodes}
        return mended(document, self.folder) if random.random() < 0.85 else document

    def add(self, key: str) -> None:
        """A node of that module, each required input linked."""
        declared = declaration(standard_library()[key])
        random = self.random
        links = []
        for port in declared.inputs:
            if port.required or random.random() < 0.4:
                source = self._source(port)
                if source is not None:
                    links.append((source, port.name))
        name = self._name(key)
        node: Document = {"module": key}
        params = self._params(declared)
        if params:
            node["params"] = params
        if random.random() < 0.06:
            node["disabled"] = True
        if random.random() < 0.1:
            node["auto"] = random.random() < 0.5
        self.nodes[name] = node
        self.links += [[source, f"{name}.{port}"] for source, port in links]
        for port in declared.outputs:
            self.ports.setdefault(port.types[0], []).append(f"{name}.{port.name}")

    def _source(self, port: Port) -> str | None:
        kind = self.random.choice(port.types)
        self._need(kind)
        found = self.ports.get(kind, [])
        if not found:
            return None
        return found[-1] if self.random.random() < 0.8 else self.random.choice(found)

    def _need(self, kind: str) -> None:
        if not self.ports.get(kind):
            self.add(self.random.choice(MAKERS[kind]))

    def _name(self, key: str) -> str:
        number = len(self.nodes)
        return self.random.choice(
            (f"{key}_{number}", f"{key}_{number}", f"n{number}", f"ζ {number}", f"${number}_x$")
        )

    def _size(self) -> tuple[int, int]:
        """Rows and columns of the network's pictures: of 100, 2 are large and 4 a single line."""
        random = self.random
        chosen = random.random()
        if chosen < 0.02:
            return random.choice(LARGE_SIDES), random.choice((*LARGE_SIDES, 3, 1))
        if chosen < 0.06:
            line = (1, random.choice((2, 7, 64, 127, 211)))
            return line if random.random() < 0.5 else line[::-1]
        return self._length(), self._length()

    def _length(self) -> int:
        return self.random.choice((self.side, self.side, self.random.randint(1, LARGEST_SIDE)))

    def _frame(self, number: int) -> str:
        """A picture file; most frames of a network have one size."""
        drawn = np.random.default_rng(self.random.getrandbits(32))
        rows, columns = self.size if number == 0 else (self._length(), self._length())
        kind = self.random.choice(("scene", "scene", "constant", "zero", "wide", "signed", "point"))
        point = np.zeros((rows, columns))
        point[drawn.integers(rows), drawn.integers(columns)] = 50.0
        samples = {
            "scene": drawn.uniform(20, 60, (rows, columns)),
            "constant": np.full((rows, columns), 37.25),
            "zero": np.zeros((rows, columns)),
            "wide": 10 ** drawn.uniform(-6, 6, (rows, columns)),
            "signed": drawn.normal(0, 15, (rows, columns)),
            "point": point,
        }[kind]
        name = f"frame{number}.npy"
        np.save(self.folder / name, samples.astype(self.random.choice(("f4", "f8"))))
        return name

    def _params(self, declared: Declaration) -> Document:
        random, key = self.random, declared.key
        params = dict(random.choice(({}, EXAMPLES[key], random.choice(SETTINGS.get(key, [{}])))))
        if key == "init_trans" and random.random() < 0.85:
            params |= SENSOR
        if key in ("test_scene", "read_image") and random.random() < 0.8:
            params |= {"fov_x_deg": random.choice((0.2, 1.5, 10)), "fov_y_deg": 1.5}
        chance = random.choice((0.0, 0.1, 0.3, 0.7))
        for parameter in declared.parameters:
            if random.random() < chance:
                params[parameter.name] = self._value(parameter)
        if key == "test_scene":
            # The default is one of those that take longest to draw.
            if "kind" not in params:
                params["kind"] = random.choice(declared.parameter("kind").choices)
            params["height"], params["width"] = self.size if random.random() < 0.8 else (9, 14)
        if key == "exit_pupil" and random.random() < 0.9:
            params |= SMALL_PUPIL
        if key in ("read_image", "noise_file"):
            params["path"] = random.choice(self.files)
        if declared.sink and "path" in (p.name for p in declared.parameters):
            suffix = random.choice((".png", ".tif", ".exr", ".npy", ".csv", ".png", ".xyz"))
            params["path"] = f"written {len(self.nodes)}{suffix}"
        return params

    def _value(self, parameter: Parameter) -> Any:
        random = self.random
        if parameter.empty and random.random() < 0.15:
            return None
        if parameter.kind == "switch":
            return random.random() < 0.5
        if parameter.kind == "choice":
            return random.choice(parameter.choices)
        if parameter.kind == "text":
            return random.choice(UNITS)
        if parameter.kind == "path":
            return random.choice([*self.files, "nowhere.npy"])
        if parameter.kind == "numbers":
            return [random.uniform(-0.5, 0.5) for _ in range(random.randint(0, 12))]
        if parameter.kind == "integer":
            return self._integer(parameter)
        return self._number(parameter)

    def _integer(self, parameter: Parameter) -> int:
        random, param = self.random, parameter.param
        low = int(param.low) if param.low is not None else -5
        high = param.high
        if parameter.name in SIZES or high is None:
            high = LARGEST_SIDE if high is None else min(high, LARGEST_SIDE)
        return random.choice((low, int(high), random.randint(low, min(int(high), low + 40))))

    def _number(self, parameter: Parameter) -> float:
        random, param = self.random, parameter.param
        low = -math.inf if param.low is None else param.low
        high = math.inf if param.high is None else param.high
        lowest = math.nextafter(low, math.inf) if param.above else low
        highest = math.nextafter(high, -math.inf) if param.below else high
        if random.random() < self.extremes:
            return min(max(random.choice(EXTREME), lowest), highest)
        if random.random() < 0.12:
            # The ends themselves; just inside an open one is as extreme as a number can be.
            ends = [end for end in (low, high) if end in (lowest, highest) and math.isfinite(end)]
            if ends:
                return float(random.choice(ends))
        middle = parameter.default if isinstance(parameter.default, float) else 1.0
        number = (middle or 1.0) * 10 ** random.uniform(-1.5, 1.5)
        if low < 0 and random.random() < 0.3:
            number = -number
        number = min(max(number, lowest), highest)
        return float(f"{number:.3g}") if lowest < float(f"{number:.3g}") < highest else number
