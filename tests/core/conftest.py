"""A small library of modules and a network made of them; an engine that counts."""

import copy
import json
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

import pytest

from core.chain.wires import Context, Image, Magnitude, Phase, Transfer
from core.errors import ParameterError
from core.modules.declaration import Module, NodeContext
from core.modules.parameters import Param
from engine_bench import Bench


class ImageOutputs(NamedTuple):
    image: Image


class Scene(Module, key="scene_maker", title="Scene", group="Input", replaces=("old_scene",)):
    """A made-up scene."""

    renamed: ClassVar[dict[str, str]] = {"columns": "width", "picture": "image"}

    kind: Annotated[Literal["dormitory", "point"], Param("what it shows")] = "dormitory"
    width: Annotated[int, Param("columns", low=1)] = 512
    spots: Annotated[tuple[float, ...], Param("positions", unit="mrad")] = ()
    path: Annotated[Path | None, Param("an own picture")] = None

    def run(self, here: NodeContext) -> ImageOutputs:
        raise NotImplementedError


class InitOutputs(NamedTuple):
    context: Context
    magnitude: Magnitude
    phase: Phase


class Init(Module, key="init", title="Init & Trans", group="Transform"):
    """To the spectrum."""

    focal_length_mm: Annotated[float | None, Param("focal length", unit="mm", low=0)] = None
    near_m: Annotated[float, Param("nearest", unit="m", low=0)] = 1.0
    far_m: Annotated[float, Param("farthest", unit="m", low=0)] = 2.0

    def check(self) -> None:
        if self.near_m > self.far_m:
            raise ParameterError("near_m", self.near_m, f"at most far_m = {self.far_m}", unit="m")

    def run(self, image: Image) -> InitOutputs:
        raise NotImplementedError


class JitterOutputs(NamedTuple):
    magnitude: Magnitude
    mtf: Transfer


class Jitter(Module, key="jitter_mtf", title="Jitter MTF", group="Motion"):
    """Random motion."""

    sigma_mrad: Annotated[float, Param("rms motion", unit="mrad", low=0)] = 0.02

    def run(self, context: Context, magnitude: Magnitude) -> JitterOutputs:
        raise NotImplementedError


class NoiseOutputs(NamedTuple):
    image: Image
    noise: Image


class Noise(Module, key="noise", title="Noise", group="Noise"):
    """Adds noise."""

    percent: Annotated[float, Param("its size", low=0, high=100)] = 1.0

    def run(self, image: Image) -> NoiseOutputs:
        raise NotImplementedError


class Back(Module, key="back", title="Back Transform", group="Transform"):
    """To the image."""

    def run(self, magnitude: Magnitude, phase: Phase) -> ImageOutputs:
        raise NotImplementedError


class Look(Module, key="look", title="Examine", group="Output", sink=True):
    """Looks at a wire."""

    level: Annotated[float, Param("a level that must be given")]

    def run(self, picture: Image | Transfer, other: Image | None) -> None:
        raise NotImplementedError


MODULES: tuple[type[Module], ...] = (Scene, Init, Jitter, Noise, Back, Look)

FORMATTED = """{
  "format": "imagechain-network",
  "version": 1,
  "name": "Kodak KIR-310",
  "description": "µ-bolometer, 30°",
  "seed": 1996,
  "nodes": {
    "scene": {
      "module": "scene_maker",
      "params": {
        "kind": "point",
        "spots": [0.0, 1.5],
        "width": 1024
      }
    },
    "init": {
      "module": "init",
      "params": {
        "focal_length_mm": 200.0
      },
      "pinned": true
    },
    "jitter": {
      "module": "jitter_mtf",
      "params": {
        "sigma_mrad": 0.5
      },
      "auto": false
    },
    "back": {
      "module": "back"
    },
    "add noise": {
      "module": "noise",
      "disabled": true
    },
    "look": {
      "module": "look",
      "params": {
        "level": 1.0
      }
    }
  },
  "links": [
    ["scene.image", "init.image"],
    ["init.context", "jitter.context"],
    ["init.magnitude", "jitter.magnitude"],
    ["init.phase", "back.phase"],
    ["jitter.magnitude", "back.magnitude"],
    ["back.image", "add noise.image"],
    ["add noise.image", "look.picture"]
  ],
  "layout": {
    "scene": [0, 0],
    "init": [220, -12.5]
  },
  "backdrops": [
    {
      "title": "Optics",
      "nodes": ["init", "jitter"]
    }
  ]
}
"""

DOCUMENT: dict[str, Any] = json.loads(FORMATTED)
# Otherwise than the file has it: whole numbers, and another order of the links.
DOCUMENT["nodes"]["scene"]["params"]["spots"] = [0, 1.5]
DOCUMENT["nodes"]["init"]["params"]["focal_length_mm"] = 200
DOCUMENT["nodes"]["look"]["params"]["level"] = 1
DOCUMENT["links"].insert(3, DOCUMENT["links"].pop(4))


@pytest.fixture
def bench() -> Bench:
    return Bench()


@pytest.fixture(scope="session")
def small_library() -> dict[str, type[Module]]:
    return {module.key: module for module in MODULES}


@pytest.fixture
def formatted() -> str:
    return FORMATTED


@pytest.fixture
def document() -> dict[str, Any]:
    """A sound network as plain data, to be changed at will."""
    return copy.deepcopy(DOCUMENT)


@pytest.fixture(scope="session")
def sound_text() -> str:
    """The file of a sound network."""
    return json.dumps(DOCUMENT, indent=2, ensure_ascii=False)
