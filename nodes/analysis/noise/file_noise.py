"""Noise of frames in a file, of a camera say, as the noise of simulated frames."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from core.chain.results import CurveData, TableData
from core.chain.wires import Image
from core.errors import DataError
from core.evaluation.recipes import Recipe, Step, ends_lineage
from core.evaluation.work import Work
from core.modules.declaration import NodeContext
from core.physics.noise.noise_cube import MeasuredNoise, NoiseCube
from nodes.analysis.noise.frame_noise import bars_of, table_of
from nodes.files.common.paths import readable_file
from nodes.files.frames.frame_reading import FrameFile, open_frames
from nodes.files.headers.envi_header import header_beside
from nodes.input_output.source_file import Stamp, check_unchanged, stamps_of


def frames_in_file(path: Path, here: NodeContext, image: Image | None) -> tuple[Recipe, str]:
    """Recipe of the noise of the frames in a file, and their unit, empty where it names none.

    Raises
    ------
    FileError
        The file is missing, damaged or of an unknown format.
    DataError
        It holds a single frame, or its frames are not those of the picture that predicts their
        noise: of another size or unit.
    """
    file = readable_file((here.folder / path).absolute())
    stamps = stamps_of(file, header_beside(file))
    known = _described(file, stamps)
    if known.frames < 2:
        raise DataError(f"{file}: holds a single frame; noise in time needs 2 or more")
    if image is not None and image.shape != (known.rows, known.columns):
        raise DataError(
            f"{file}: holds frames of {known.rows} × {known.columns} samples, and the picture that "
            f"predicts their noise has {image.rows} × {image.columns}: link that camera's, or none"
        )
    if image is not None and known.unit and known.unit != image.unit:
        raise DataError(
            f"{file}: holds frames in {known.unit!r:.40}, and the picture that predicts their "
            f"noise is in {image.unit!r:.40}: link one in the same unit, or none"
        )
    if known.path != file:
        stamps += stamps_of(known.path)
    return Step.of(measured_in_file, node=here.node, path=file, stamps=stamps), known.unit or ""


@lru_cache(maxsize=64)
def _described(path: Path, stamps: tuple[Stamp, ...]) -> FrameFile:
    """Description of the file in the state of these stamps, so that planning again costs less."""
    return open_frames(path)


@ends_lineage
def measured_in_file(work: Work, *, path: Path, stamps: tuple[Stamp, ...]) -> MeasuredNoise:
    """Components of the noise; all that stays from frame to frame counts as a pattern.

    Raises
    ------
    FileError
        The file cannot be read, or is another one than was planned with.
    DataError
        Its frames have a single row or column, or samples that are not finite.
    """
    check_unchanged(path, stamps)
    file = _described(path, stamps)
    cube = NoiseCube(file.rows, file.columns)
    for frame in file.each():
        work.check()
        cube.add(frame)
    return cube.measured()


@ends_lineage
def table_of_file(work: Work, measured: MeasuredNoise, *, unit: str) -> TableData:
    """The components that were measured, where nothing is predicted."""
    return table_of(work, None, measured, unit=unit)


@ends_lineage
def bars_of_file(work: Work, measured: MeasuredNoise, *, unit: str) -> CurveData:
    """The components that were measured as bars, where nothing is predicted."""
    return bars_of(work, None, measured, unit=unit)
