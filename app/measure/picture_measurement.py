"""What a measurement of pictures has given, as values that never change."""

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.physics.measurement import edge_mtf
from core.physics.measurement.found_edge import FoundEdge
from core.physics.measurement.picture_noise import FramesNoise
from core.physics.measurement.sample_noise import LevelVariance
from core.records import dataclass

Gamma = Literal["", "possible", "usual"]

FREQUENCIES = tuple(step / 64.0 for step in range(65))
"""Cycles per sample at which every MTF is given: of 64 samples, and up to the samples' own."""
BY_HAND = "removed by you"
WITH_LOSS = "compressed with loss (fine detail and noise are altered)"


@dataclass(frozen=True, eq=False)
class MeasuredEdge:
    picture: int  # its number among those measured, from 0
    found: FoundEdge  # where it is, and what of the picture belongs to it
    curve: edge_mtf.EdgeMtf | None  # MTF along the normal; None where it was not measured
    why_not: str  # why it is not used; empty where it is

    @property
    def used(self) -> bool:
        return not self.why_not

    @property
    def direction(self) -> str:
        """The axis that its normal lies near, ``x`` or ``y``; empty of one between both."""
        away = abs((self.found.angle_deg + 90.0) % 180.0 - 90.0)
        if away <= edge_mtf.LARGEST_ANGLE_DEG:
            return "x"
        return "y" if away >= 90.0 - edge_mtf.LARGEST_ANGLE_DEG else ""

    @property
    def mtf50_sigma(self) -> float | None:
        """Standard error of the MTF50, as that of its direction where it alone shows it."""
        curve = self.curve
        if curve is None or curve.mtf50 is None:
            return None
        alone = edge_mtf.pooled_mtf(edges=[curve], axis="y" if self.direction == "y" else "x")
        if alone is None:
            return curve.mtf50_sigma
        own = {"frequency": alone.frequency, "mtf": alone.mtf, "sigma": alone.sigma}
        return edge_mtf.crossing_error(**own, crossing=curve.mtf50)

    @property
    def stretch(self) -> float:
        """What a frequency along the normal is multiplied by to be that along the axis."""
        return max(abs(part) for part in self.found.normal)


@dataclass(frozen=True, eq=False)
class Preview:
    picture: int  # its number among those measured
    samples: NDArray[np.float32]  # means of squares of `factor` samples, single precision
    factor: int  # samples along a side of such a square


@dataclass(frozen=True)
class NoiseFigures:
    """Noise of a sample in the flat areas of all pictures."""

    sigma: float  # standard deviation in the picture's unit
    sigma_error: float  # its standard error
    # by how the variance rises with the level, where levels differ enough
    gain_e_per_dn: float | None
    gain_error: float | None
    read_noise_dn: float | None
    read_noise_error: float | None
    offset_dn: float  # the level without light, which the read noise is for
    mean_level: float  # of the pictures, which `sigma` is for
    # of whole rows and columns; 0 where none stands out, None where it could not be measured
    row_sigma: float | None
    column_sigma: float | None
    step: float | None  # of the converter; None where the samples show none
    levels: tuple[LevelVariance, ...]
    remarks: tuple[str, ...]
    reason: str  # why what is missing could not be measured


@dataclass(frozen=True)
class MeasuredFile:
    """A file that was measured: its name, how many pictures, and what of it was taken.

    `gamma`: whether its numbers follow the eye instead of the light, usually or possibly;
    `is_lossy`: compressed so that it is not what was taken, and nothing of it counts.
    """

    name: str
    frames: int
    taken: str
    gamma: Gamma = ""
    is_lossy: bool = False


@dataclass(frozen=True, eq=False)
class PictureMeasurement:
    files: tuple[MeasuredFile, ...]  # where the pictures come from, in order
    # size of each
    rows: int
    columns: int
    unit: str  # of the samples, or empty
    # angle between samples, where the field of view is known
    interval_x_mrad: float | None
    interval_y_mrad: float | None
    edges: tuple[MeasuredEdge, ...]  # all that were seen
    # pooled over the edges across, and along
    x: edge_mtf.MtfCurve | None
    y: edge_mtf.MtfCurve | None
    # why there is none
    reason_x: str
    reason_y: str
    noise: NoiseFigures | None  # of the flat areas of the pictures
    noise_reason: str  # why there is none
    frames: FramesNoise | None = None  # noise from frame to frame
    frames_reason: str = ""  # why there are none
    previews: tuple[Preview, ...] = ()  # the first pictures
    pitch_um: float | None = None  # from one pixel to the next, where it was given
    warnings: tuple[str, ...] = ()  # what makes the figures other than those of the camera

    @property
    def picture_count(self) -> int:
        return sum(file.frames for file in self.files)

    def interval_mrad(self, direction: str) -> float | None:
        return self.interval_x_mrad if direction == "x" else self.interval_y_mrad

    def picture_name(self, number: int) -> str:
        """The name of a picture, with the frame's number in a file of several."""
        file, frame = file_of(self.files, number)
        return file.name if file.frames == 1 else f"{file.name}, frame {frame}"


def file_of(files: Sequence[MeasuredFile], number: int) -> tuple[MeasuredFile, int]:
    for file in files:
        if number < file.frames:
            return file, number
        number -= file.frames
    raise IndexError(number)
