"""Noise File: any picture as noise."""

from pathlib import Path

import numpy as np

from core.chain.step_lineage import Array, picture_step
from core.chain.wires import Image
from core.errors import DataError
from core.evaluation.recipes import pointwise
from core.evaluation.work import Work
from core.modules.declaration import Formula, Module, NodeContext, param
from nodes.files.stored_bytes import checked_band
from nodes.input_output.source_file import picture_source, read_step
from nodes.shared.module_ports import NoiseOutputs


class NoiseFile(Module, key="noise_file", title="Noise File", group="Electronics & Noise"):
    """Add noise from a file, times `scale`, to a picture of the same size.

    The file may have any format that Read Image reads. The mean of the noise is added too. A scale
    of 0 changes nothing. Source: Tantalo 1996, chapter 3.
    """

    formulas = (Formula(r"L'=L+s\,n", where="n: samples of the file; s: scale"),)

    path: Path | None = param(None, "noise file, relative to the network file's folder")
    band: int = param(0, "band or channel to read, counted from 0", low=0)
    scale: float = param(1.0, "factor that converts the file to the picture's unit", slider=(0, 10))

    def run(self, image: Image, here: NodeContext) -> NoiseOutputs:
        source = picture_source(self.path, here)
        info = source.info
        checked_band(self.band, info.bands, info.path)
        if (info.rows, info.columns) != image.shape:
            raise DataError(
                f"the noise in {info.path.name} has {info.columns} × {info.rows} samples and the "
                f"picture has {image.columns} × {image.rows}: give a noise file of the same size"
            )
        noise = read_step(source, band=self.band, scale=self.scale, node=here.node)
        if self.scale == 0.0:
            return NoiseOutputs(image, image.with_recipe(noise))
        total = here.step(with_file, image.recipe, noise)
        return NoiseOutputs(image.with_recipe(total), image.with_recipe(noise))


@picture_step(noise=lambda at, *_: [at.known("file")])
@pointwise
def with_file(work: Work, image: Array, noise: Array) -> Array:
    return np.add(image, noise, dtype=work.policy.dtype)
