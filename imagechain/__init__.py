"""Simulate electro-optical and infrared cameras as a chain of transfer functions and noise.

    import imagechain as ic

    chain = ic.open("kodak_kir310")                 # an example network by name, or a file
    chain.set("electronics.amplifier_snr", 40)
    result = chain.run()
    result.image()                                  # the picture, a numpy array
    result.readouts, result.curves()                # figures and transfer functions

or build your own chain:

    chain = ic.Chain("Mine", seed=1)
    chain.add(ic.scene(radiance, fov_x_deg=10, fov_y_deg=8))
    chain.add(ic.modules.init_trans(f_number=2))
    chain.add(ic.modules.gaussian_mtf(sigma_x_mrad=0.3, sigma_y_mrad=0.3), name="blur")
    chain.add(ic.modules.back_transform())

`ic.modules` has every module, with the units and ranges of its parameters. `ic.measure` measures a
camera's pictures, and `ic.fit` fits a chain's parameters to them. `ic.physics` has individual
formulas.
"""

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from imagechain.own_packages import load_own_packages

load_own_packages(Path(__file__).resolve().parent.parent)

if TYPE_CHECKING:
    from core.chain.wires import CurveData, TableData
    from core.errors import (
        Cancelled,
        ChangedFileError,
        DataError,
        FileError,
        ImagechainError,
        InputError,
        NetworkError,
        ParameterError,
        UnconnectedError,
        UsageError,
    )
    from core.modules.parameters import Caution
    from imagechain import modules, physics
    from imagechain.building.camera import Camera
    from imagechain.building.chain import Chain, networks, open
    from imagechain.building.chain_state import ChainNode
    from imagechain.building.chain_study import study
    from imagechain.building.measure_pictures import FittedChain, MeasuredPictures, fit, measure
    from imagechain.parts.module_part import Expression, Part, part, preset, presets, scene
    from imagechain.results.chain_result import Result
    from imagechain.results.tables import Picture, ReadoutTable, StageCurves, StudyTable

    expression = Expression
    __version__: str

__all__ = [
    "Camera",
    "Cancelled",
    "Caution",
    "Chain",
    "ChainNode",
    "ChangedFileError",
    "CurveData",
    "DataError",
    "Expression",
    "FileError",
    "FittedChain",
    "ImagechainError",
    "InputError",
    "MeasuredPictures",
    "NetworkError",
    "ParameterError",
    "Part",
    "Picture",
    "ReadoutTable",
    "Result",
    "StageCurves",
    "StudyTable",
    "TableData",
    "UnconnectedError",
    "UsageError",
    "__version__",
    "expression",
    "fit",
    "measure",
    "modules",
    "networks",
    "open",
    "part",
    "physics",
    "preset",
    "presets",
    "scene",
    "study",
]

# Where each name lies; imported when it is first used.
_NAMES = {
    "core.chain.wires": "CurveData TableData",
    "core.errors": "Cancelled ChangedFileError DataError FileError ImagechainError InputError "
    "NetworkError ParameterError UnconnectedError UsageError",
    "core.modules.parameters": "Caution",
    "imagechain.building.camera": "Camera",
    "imagechain.building.chain": "Chain networks open",
    "imagechain.building.chain_state": "ChainNode",
    "imagechain.building.chain_study": "study",
    "imagechain.building.measure_pictures": "FittedChain MeasuredPictures fit measure",
    "imagechain.parts.module_part": "Expression Part part preset presets scene",
    "imagechain.results.chain_result": "Result",
    "imagechain.results.tables": "Picture ReadoutTable StageCurves StudyTable",
}
_PLACES = {name: place for place, names in _NAMES.items() for name in names.split()}


if not TYPE_CHECKING:  # so that a name that is not there is an error of the types

    def __getattr__(name: str) -> object:
        if name in ("modules", "physics"):
            return import_module(f"imagechain.{name}")
        if name == "expression":
            value = import_module("imagechain.parts.module_part").Expression
        elif name == "__version__":
            value = import_module("app.run.terminal").version()
        elif name in _PLACES:
            value = getattr(import_module(_PLACES[name]), name)
        else:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted(__all__)
