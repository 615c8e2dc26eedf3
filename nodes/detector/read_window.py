"""Read-out Window: a region of interest (ROI) is read instead of the whole detector."""

import numpy as np

from core.chain.noise_power import NoisePower
from core.chain.step_lineage import Array, Axis, Linear, Vector, picture_step
from core.chain.wires import Image
from core.errors import ParameterError
from core.evaluation.recipes import Region, Seen, by_region
from core.evaluation.work import Work
from core.modules.declaration import Formula, Module, NodeContext, Section, param, readout
from core.records import dataclass
from core.transfer.factors import Grid
from nodes.shared.module_ports import ImageOutput


class ReadWindow(Module, key="read_window", title="Read-out Window", group="Detector"):
    """Read a window of the detector, the region of interest (ROI), and drop all other pixels.

    An empty offset centres the window. Put this module after Focal Plane or Microbolometer: the
    pixels keep their noise and their fixed pattern, whatever the window. Transfer functions, NETD
    and SNR do not change. Fewer rows are read faster: `frame_rate_Hz` is the highest rate of a
    detector that reads row by row, with an overhead for each frame. Source: EMVA 1288 release 4.0,
    section 2 (region of interest); the frame rate follows from the row time on the data sheet.
    """

    formulas = (
        Formula(
            r"f=\frac{1}{n_r\,t_r+t_0}",
            where="n_r: rows of the window; t_r: row_time_us; t₀: overhead_us",
        ),
    )

    columns: int | None = param(
        None, "width of the window; empty: all columns", (1, 65536), unit="px", slider=(16, 2048)
    )
    rows: int | None = param(
        None, "height of the window; empty: all rows", (1, 65536), unit="px", slider=(16, 2048)
    )
    left: int | None = param(
        None,
        "columns to the left of the window; empty: centred",
        (0, 65535),
        unit="px",
        slider=(0, 2048),
        zero_is_empty=False,
    )
    top: int | None = param(
        None,
        "rows above the window; empty: centred",
        (0, 65535),
        unit="px",
        slider=(0, 2048),
        zero_is_empty=False,
    )
    row_time_us: float | None = param(
        None, "time to read one row", (1e-6, 1e9), unit="µs", slider=(1, 100)
    )
    overhead_us: float = param(
        0.0,
        "time that each frame takes in addition to reading its rows",
        (0, 1e9),
        unit="µs",
        slider=(0, 1000),
    )

    panel = (
        Section("Window", "columns rows left top"),
        Section("Frame rate", "row_time_us overhead_us"),
    )

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        rows, columns = self.rows or image.rows, self.columns or image.columns
        window = Region(self._place("y", image), self._place("x", image), rows, columns)
        if window.shape == image.shape:
            return ImageOutput(image)
        step = here.step(windowed, image.recipe, window=window, old=image.shape)
        made = image.with_recipe(step, rows=window.rows, columns=window.columns)
        return ImageOutput(made)

    def _place(self, axis: Axis, image: Image) -> int:
        size, own, first, what = (
            (image.columns, self.columns, self.left, "columns")
            if axis == "x"
            else (image.rows, self.rows, self.top, "rows")
        )
        wanted = own or size
        if wanted > size:
            allowed = f"at most {size}, the number of {what} in the picture"
            raise ParameterError(what, wanted, allowed)
        start = (size - wanted) // 2 if first is None else first
        if start + wanted > size:
            name = "left" if axis == "x" else "top"
            allowed = (
                f"at most {size - wanted}, so that the window lies within the picture's "
                f"{size} {what}"
            )
            raise ParameterError(name, start, allowed)
        return start

    @readout("Hz", name="frame_rate_Hz")
    def frame_rate(self, outputs: ImageOutput) -> float | None:
        """Highest frame rate of this window; left out if row_time_us is empty."""
        if self.row_time_us is None:
            return None
        return 1e6 / (outputs.image.rows * self.row_time_us + self.overhead_us)


@dataclass(frozen=True)
class Windowed(Linear):
    window: Region
    old: tuple[int, int]

    def size_before(self, rows: int, columns: int) -> tuple[int, int]:
        return self.old

    def grid_before(self, grid: Grid) -> Grid:
        return Grid(*self.old, grid.interval_x_mrad, grid.interval_y_mrad)

    def noise(self, work: Work, power: NoisePower) -> NoisePower:
        return power.cropped(*self.window.slices)

    def row(self, work: Work, row: Vector, axis: Axis) -> Vector:
        return row[self.window.slices[1 if axis == "x" else 0]]


@picture_step(linear=lambda _, **how: Windowed(**how))
@by_region(lambda _, *, window, **__: window.shape)
def windowed(
    work: Work, region: Region, picture: Seen, *, window: Region, old: tuple[int, int]
) -> Array:
    wanted = Region(window.top + region.top, window.left + region.left, *region.shape)
    return np.ascontiguousarray(picture(wanted))
