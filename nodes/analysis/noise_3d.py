"""3-D Noise: the seven noise components of a sequence of frames."""

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.chain.wires import Curve, CurveData, Image, Series, Table, TableData
from core.errors import DataError, ParameterError
from core.evaluation.recipes import Recipe
from core.evaluation.work import Work
from core.modules.declaration import Formula, Module, NodeContext, Section, param
from core.physics.noise.noise_components import (
    COMPONENTS,
    MEANINGS,
    MeasuredNoise,
    NoiseCube,
    NoiseVariances,
)
from nodes.analysis.lineage import ImageNoise, NoiseOf, noise_free
from nodes.files.envi_header import header_beside
from nodes.files.frames import FrameFile, open_frames
from nodes.files.stored_bytes import readable_file
from nodes.input_output.source_file import Stamp, check_unchanged, stamps_of
from nodes.shared.module_ports import TableFigures
from nodes.shared.steps import OverFrames


class NoiseOutputs(NamedTuple):
    curve: Curve
    table: Table


class Noise3D(Module, key="noise_3d", title="3-D Noise", group="Analysis"):
    """Split noise into its 3-D components: time (t), rows (v), columns (h), and their combinations.

    Predicted: the noise of every source in the chain is propagated to this picture through all
    later transfer functions, pixel combining and interpolation. Measured: frames of the picture are
    simulated, each with its own temporal noise and the same fixed patterns. The noise-free picture
    is subtracted, and unbiased estimates split the variance into the seven components. The
    prediction is an average over all sensors of the same design; the measurement contains one
    sensor's pattern. With few rows or columns, the measured fixed components therefore scatter
    about the prediction. Noise correlated between neighbouring samples also appears in σ tv and σ
    th. Quantization noise is included. With `path`, the frames of a file, for example from a
    camera, are measured instead of simulated frames; they are read one at a time. In a file,
    everything that stays the same from frame to frame, including the scene, counts as fixed
    pattern. Use frames of a uniform scene. If a picture is also connected, its predicted noise is
    shown beside the measurement. Sources: D'Agostino and Webb 1991; Scott and D'Agostino 1992
    (FLIR92); Searle, Casella and McCulloch 1992, Variance Components (unbiased estimates).
    """

    formulas = (
        Formula(
            r"N=N_t+N_v+N_h+N_{tv}+N_{th}+N_{vh}+N_{tvh}",
            where=(
                "independent fields that vary with time (t), row (v), column (h), or several "
                "of these"
            ),
        ),
        Formula(
            r"\sigma^2=\sigma_t^2+\sigma_v^2+\sigma_h^2+\sigma_{tv}^2+\sigma_{th}^2+\sigma_{"
            r"vh}^2+\sigma_{tvh}^2",
            where="unbiased estimates from the analysis of variance",
        ),
    )

    frames: int = param(
        16,
        "number of frames to simulate; 0: prediction only; with path, all frames of the file "
        "are measured",
        (0, 100000),
        slider=(0, 200),
    )
    path: Path | None = param(
        None,
        "file of frames to measure instead of simulated frames: .npy (frames, rows, "
        "columns), TIFF with a page per frame, or ENVI with a band per frame; empty: "
        "simulate",
    )

    panel = (Section("Measurement", "frames path"),)

    def check(self) -> None:
        if self.frames == 1:
            raise ParameterError("frames", 1, "0, or at least 2")

    def run(self, here: NodeContext, image: Image | None = None) -> NoiseOutputs:
        if image is None and self.path is None:
            raise ParameterError(
                "path", None, "give a file of frames, or connect a picture to image"
            )
        noises: tuple[Recipe, ...] = ()
        unit = "" if image is None else image.unit
        if image is not None:
            noises = (NoiseOf(image, node=here.node),)
        if self.path is not None:
            measured, of_file = frames_in_file(self.path, here, image)
            unit = of_file or unit
            noises = (*noises, measured)
        elif self.frames and image is not None:
            how: Any = {"others": (noise_free(image.recipe),), "node": here.node}
            noises += (OverFrames(noise_of_frames, image.recipe, self.frames, **how),)
        bars = here.step(bars_of, *noises, unit=unit)
        table = here.step(table_of, *noises, unit=unit)
        return NoiseOutputs(Curve(bars), Table(table))

    figures = TableFigures(
        *((f"sigma_{n}", None, f"{MEANINGS[n].capitalize()}, predicted.") for n in COMPONENTS),
        ("temporal", None, "All temporal noise, predicted."),
        ("fixed", None, "All fixed-pattern noise, predicted."),
        ("temporal_measured", None, "All temporal noise, measured."),
        ("fixed_measured", None, "All fixed-pattern noise, measured."),
        unit_of="image",
    )


def frames_in_file(path: Path, here: NodeContext, image: Image | None) -> tuple[Recipe, str]:
    file = readable_file((here.folder / path).absolute())
    stamps = stamps_of(file, header_beside(file))
    known = _described(file, stamps)
    if known.frames < 2:
        raise DataError(f"{file} has only one frame; temporal noise needs 2 or more")
    if image is not None and image.shape != (known.rows, known.columns):
        raise DataError(
            f"{file}: frames of {known.rows} × {known.columns} samples, but the "
            f"connected picture has {image.rows} × {image.columns}: connect a picture "
            "from the same camera, or no picture"
        )
    if image is not None and known.unit and known.unit != image.unit:
        raise DataError(
            f"{file}: frames in {known.unit!r:.40}, but the connected picture is in "
            f"{image.unit!r:.40}: connect a picture in the same unit, or no picture"
        )
    if known.path != file:
        stamps += stamps_of(known.path)
    return here.step(measured_in_file, path=file, stamps=stamps), known.unit or ""


@lru_cache(maxsize=64)
def _described(path: Path, stamps: tuple[Stamp, ...]) -> FrameFile:
    """Description of the file in the state of these stamps, so that planning again costs less."""
    return open_frames(path)


def measured_in_file(work: Work, *, path: Path, stamps: tuple[Stamp, ...]) -> MeasuredNoise:
    """Components of the noise; all that stays from frame to frame counts as a pattern."""
    check_unchanged(path, stamps)
    file = _described(path, stamps)
    cube = NoiseCube(file.rows, file.columns)
    for frame in file.each():
        work.check()
        cube.add(frame)
    return cube.measured()


def noise_of_frames(frames: Iterator[NDArray[Any]], clean: NDArray[Any]) -> MeasuredNoise:
    clean = np.asarray(clean, np.float64)
    cube = NoiseCube(*clean.shape)
    for picture in frames:
        cube.add(picture - clean)
    return cube.measured()


def table_of(work: Work, *noises: ImageNoise | MeasuredNoise, unit: str) -> TableData:
    predicted, measured = _kinds(noises)
    rows: list[tuple[Any, ...]] = []
    expected = None if predicted is None else predicted.total
    for name in COMPONENTS:
        if expected is not None:
            rows.append((f"sigma_{name}", expected.sigma(name)))
        if measured is not None:
            value, error = measured.variances.sigma(name), measured.errors.variance(name)
            rows.append((f"sigma_{name}_measured", value, unit, f"{MEANINGS[name]}, measured"))
            # The error of a root by that of its square; of one next to nothing the root of it.
            spread = error / (2.0 * abs(value)) if value * value > error else error**0.5
            rows.append((f"sigma_{name}_error", spread, unit, "its standard error"))
    if expected is not None:
        rows += [("temporal", expected.temporal**0.5), ("fixed", expected.fixed**0.5)]
    if measured is not None:
        of_time, fixed = measured.variances.temporal, measured.variances.fixed
        rows += [
            ("temporal_measured", max(of_time, 0.0) ** 0.5),
            ("fixed_measured", max(fixed, 0.0) ** 0.5),
        ]
    if predicted is not None:
        rows.append(("mean", predicted.mean, unit, "mean of the picture without noise"))
    elif measured is not None:
        rows += [
            ("mean", measured.mean, unit, "mean of all frames"),
            ("frames", measured.frames, "", "frames in the file"),
        ]
    return Noise3D.figures.table(*rows, unit=unit)


def _kinds(
    noises: tuple[ImageNoise | MeasuredNoise, ...],
) -> tuple[ImageNoise | None, MeasuredNoise | None]:
    predicted = next((one for one in noises if isinstance(one, ImageNoise)), None)
    if predicted is not None:
        predicted.require_known()
    return predicted, next((one for one in noises if isinstance(one, MeasuredNoise)), None)


def bars_of(work: Work, *noises: ImageNoise | MeasuredNoise, unit: str) -> CurveData:
    """The seven components as bars; those estimated below zero are drawn at zero."""
    predicted, measured = _kinds(noises)
    places = np.arange(float(len(COMPONENTS)))

    def heights(variances: NoiseVariances) -> NDArray[np.float64]:
        return np.array([max(variances.sigma(name), 0.0) for name in COMPONENTS])

    series = []
    if predicted is not None:
        series.append(Series("predicted", places, heights(predicted.total)))
    if measured is not None:
        series.append(Series("measured", places, heights(measured.variances)))
    names = tuple(f"σ {name}" for name in COMPONENTS)
    return CurveData(
        "Noise components", "component", f"σ ({unit})" if unit else "σ", tuple(series), bars=names
    )
