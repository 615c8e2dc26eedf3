"""Import from here what your own modules need.

    from imagechain.plug_in import Context, Magnitude, MtfModule, MtfOutputs, NodeContext, param

The names here are stable; names in the layers below may change.
"""

from core.chain.noise_power import NoisePower
from core.chain.random_fields import Stream, normal_field
from core.chain.step_lineage import AtStep, Linear, Noise, picture_step, source_step
from core.chain.wires import Context, Image, Magnitude, Phase, Pupil, Transfer
from core.errors import DataError, FileError, ParameterError
from core.evaluation.recipes import Recipe, Step, ends_lineage, in_blocks, in_parts, pointwise
from core.evaluation.work import Work
from core.modules.declaration import Module, NodeContext, readout, warning
from core.modules.parameters import Caution, Formula, Param, Section, param
from core.transfer.factors import Law, Planar, Separable
from nodes.shared.deviates import SeededModule
from nodes.shared.module_ports import (
    Apply,
    ImageOutput,
    MtfModule,
    MtfOutputs,
    PtfModule,
    PtfOutputs,
    radial,
    separable,
)

__all__ = [
    "Apply",
    "AtStep",
    "Caution",
    "Context",
    "DataError",
    "FileError",
    "Formula",
    "Image",
    "ImageOutput",
    "Law",
    "Linear",
    "Magnitude",
    "Module",
    "MtfModule",
    "MtfOutputs",
    "NodeContext",
    "Noise",
    "NoisePower",
    "Param",
    "ParameterError",
    "Phase",
    "Planar",
    "PtfModule",
    "PtfOutputs",
    "Pupil",
    "Recipe",
    "Section",
    "SeededModule",
    "Separable",
    "Step",
    "Stream",
    "Transfer",
    "Work",
    "ends_lineage",
    "in_blocks",
    "in_parts",
    "normal_field",
    "param",
    "picture_step",
    "pointwise",
    "radial",
    "readout",
    "separable",
    "source_step",
    "warning",
]
