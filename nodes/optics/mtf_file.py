"""MTF File: a measured MTF, or one of a data sheet or a lens design, from a table."""

import math
import re
from collections.abc import Callable, Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.chain.wires import Context, Magnitude, Phase
from core.errors import DataError, FileError, ParameterError
from core.modules.declaration import Caution, Formula, NodeContext, Section, param, readout, warning
from core.physics.optics import blur as physics
from core.records import dataclass
from core.transfer.factors import Factor, Law, Part, Planar, Separable
from nodes.files.arrays import is_npy, npy_header, whole_npy
from nodes.files.curve_tables import MTF_COLUMNS, PHASE_COLUMNS, MtfTable, read_mtf_table
from nodes.files.envi_header import header_beside
from nodes.files.file_format import BLANKS, CSV
from nodes.files.formats import read_info, read_pixels
from nodes.files.stored_bytes import checked_band, readable_file
from nodes.files.table_cells import cells_of, lens_lines, line_refused, numbers_of
from nodes.input_output.source_file import Stamp, check_unchanged, stamps_of
from nodes.shared import context_defaults
from nodes.shared.module_ports import Apply, NyquistReadouts, OtfOutputs, otf_outputs, separable

ENDS_LOW = 0.02  # an MTF that ends above is cut off by the file, not by the optics
Scales = tuple[float, float]
Curves = dict[str, tuple[physics.Column, physics.Column]]


class MtfFile(NyquistReadouts, key="mtf_file", title="MTF File", group="Optics"):
    """Apply an MTF from a file: measured, from a data sheet, or from a lens design.

    The file is a CSV table whose first line names its columns. The frequency comes first, with its
    unit, as in `frequency (cyc/mm)`. The next column is `mtf` or `radial`; alternatively, give
    `mtf_x`, `mtf_y` or both. If the phase is known, add `phase`, or `phase_x` and `phase_y`, in rad
    or `(deg)`. Zemax text listings of MTF against frequency are also read; the tangential curve
    acts along y. `direction` sets the axis along which a column `mtf` acts, or selects one of
    several curves; `radial` means the same MTF in all directions. Between points the curve is a
    monotone cubic (PCHIP). A table that begins above frequency 0 gets an MTF of 1 at 0. Beyond the
    last point the MTF is 0; it is never extrapolated. The phase is odd in frequency and is
    interpolated the shorter way round.

    Frequencies are per mm at the focal plane (converted with the focal length), per mrad, or per
    pixel (converted with pitch and focal length). `imagechain measure` writes a table in this
    format from a camera's pictures; the measured MTF includes the pixel. Without a file nothing
    changes. Source: Fritsch and Butland 1984, SIAM J. Sci. Stat. Comput. 5, 300 (interpolation).
    """

    formulas = (
        Formula(
            r"H(\xi)=M(\nu),\quad\xi=\frac{\nu f}{1000}=\frac{u\,f}{p}",
            where="M: the file's curve, with PCHIP between its points; ν: cycles/mm at the "
            "focal plane; u: cycles per pixel; f: focal length, mm; p: pitch, µm; ξ: "
            "cycles/mrad",
        ),
    )

    path: Path | None = param(
        None, "CSV table of MTF, relative to the network file's folder; empty: no blur"
    )
    frequency_unit: Literal["file", "cyc/mm", "cyc/mrad", "cyc/pixel"] = param(
        "file", "unit of the frequencies; `file`: from the file's header line"
    )
    direction: Literal["file", "x", "y", "radial"] = param(
        "file",
        "axis along which the curve acts; `file`: from the name of the curve's column, "
        "where the name mtf means radial",
    )
    normalise: Literal["refuse", "at_zero"] = param(
        "refuse",
        "treatment of an MTF that is not 1 at zero frequency: refuse the file, or "
        "divide the MTF by its value there",
    )
    field: int = param(
        0,
        "field position in a Zemax listing, counted from 0, skipping the diffraction limit",
        (0, 1000),
        slider=(0, 12),
    )
    focal_length_mm: float | None = param(
        None,
        "focal length, for cyc/mm and cyc/pixel; empty: from Init & Trans",
        low=0,
        slider=(10, 10000),
    )
    detector_x_um: float | None = param(
        None,
        "horizontal pixel pitch, for cyc/pixel; empty: from Init & Trans",
        low=0,
        slider=(1, 100),
    )
    detector_y_um: float | None = param(
        None,
        "vertical pixel pitch, for cyc/pixel; empty: from Init & Trans",
        low=0,
        slider=(1, 100),
    )
    apply: Apply = "multiply"

    panel = (
        Section("File", "path field"),
        Section("Curve", "frequency_unit direction normalise"),
        Section("Focal plane", "focal_length_mm detector_x_um detector_y_um"),
        Section("Output", "apply"),
    )

    def run(
        self, context: Context, magnitude: Magnitude, here: NodeContext, phase: Phase | None = None
    ) -> OtfOutputs:
        blur: tuple[Factor, ...] = ()
        shift: tuple[Factor, ...] = ()
        if self.path is not None:
            table = read_mtf_table(here.folder / self.path, field=self.field)
            blur, shift = self._factors(table, self._scales(table, context), here.node)
        return otf_outputs(self.apply, magnitude, phase, blur=blur, shift=shift, label=self.title)

    def _scales(self, table: MtfTable, context: Context) -> Scales:
        """What cycles/mrad across and along are multiplied by to be in the file's unit."""
        unit = table.unit if self.frequency_unit == "file" else self.frequency_unit
        if table.unit not in (None, unit):
            allowed = f"the table {table.file.name} is in {table.unit}; choose {table.unit} or file"
            raise ParameterError("frequency_unit", self.frequency_unit, allowed)
        if unit is None:
            allowed = (
                f"choose cyc/mm, cyc/mrad or cyc/pixel, or name the unit in {table.file.name}, for "
                "example in a header 'frequency (cyc/mm)'"
            )
            raise ParameterError("frequency_unit", "file", allowed)
        if unit == "cyc/mrad":
            return 1.0, 1.0
        focal_length = context_defaults.given("focal_length_mm", self.focal_length_mm, context)
        if unit == "cyc/mm":
            return 1000.0 / focal_length, 1000.0 / focal_length
        x, y = (
            context_defaults.given(name, getattr(self, name), context) / focal_length
            for name in ("detector_x_um", "detector_y_um")
        )
        return x, y

    def _factors(
        self, table: MtfTable, scales: Scales, node: str
    ) -> tuple[tuple[Factor, ...], tuple[Factor, ...]]:
        mtfs, phases = self._curves(table, "mtf"), self._curves(table, "phase")
        if "radial" in phases:
            raise DataError(
                f"{table.file}: a phase needs a direction; set direction to x or y, or name "
                "the columns phase_x and phase_y"
            )
        shift = self._separable(physics.tabulated_ptf, phases, scales, "ptf", node)
        if "radial" not in mtfs:
            return self._separable(physics.tabulated_mtf, mtfs, scales, "mtf", node), shift
        frequencies, values = mtfs["radial"]
        law = Law.of(
            physics.radial_tabulated_mtf, scale=scales[0], frequencies=frequencies, values=values
        )
        cutoff = (frequencies[-1] / scales[0], frequencies[-1] / scales[1])
        # By pixels of unequal sides, what is round there is an ellipse here.
        ratios = (1.0, scales[1] / scales[0])
        blur = Planar(law, radial=True, ratios=ratios, cutoff=cutoff, label=self.title, node=node)
        return (blur,), shift

    def _separable(
        self, function: Callable[..., Any], curves: Curves, scales: Scales, part: Part, node: str
    ) -> tuple[Separable, ...]:
        x, y = (
            {"frequencies": curves[axis][0], "values": curves[axis][1]} if axis in curves else None
            for axis in ("x", "y")
        )
        how: Any = {"scale_x": scales[0], "scale_y": scales[1], "label": self.title, "node": node}
        return separable(function, x=x, y=y, part=part, **how)

    def _curves(self, table: MtfTable, kind: Literal["mtf", "phase"]) -> Curves:
        """Points by direction: x and y, or radial alone."""
        names = MTF_COLUMNS if kind == "mtf" else PHASE_COLUMNS
        columns = [(name, table.columns.get(name)) for name in names]
        curves: Curves = {}
        for name, values in columns:
            direction = self._direction(name)
            if values is None or direction is None:
                continue
            try:
                curves[direction] = physics.from_zero(
                    table.frequencies,
                    values if kind == "mtf" else tuple(map(float, np.unwrap(values))),
                    at_zero=1.0 if kind == "mtf" else 0.0,
                    normalised=kind == "mtf" and self.normalise == "at_zero",
                )
            except DataError as error:
                raise DataError(f"{table.file}: column {name}: {error.message}") from error
        if kind == "mtf" and (not curves or ("radial" in curves and len(curves) > 1)):
            present = ", ".join(name for name, values in columns if values is not None)
            allowed = f"a direction that fits the columns of {table.file.name}: {present}"
            raise ParameterError("direction", self.direction, allowed)
        return curves

    def _direction(self, name: str) -> str | None:
        own = {"x": "x", "y": "y", "radial": "radial"}.get(name.rpartition("_")[2])
        if own is None:
            return "radial" if self.direction == "file" else self.direction
        # Beside a radial MTF, the phases of both axes.
        taken = self.direction in ("file", own) or (
            self.direction == "radial" and name in PHASE_COLUMNS
        )
        return own if taken else None

    @warning
    def no_file(self) -> Caution | None:
        """No file is given, so the module does nothing."""
        if self.path is not None:
            return None
        return Caution("nothing is blurred: path is empty", "give the path of an MTF table")

    @warning
    def end(self, context: Context, outputs: OtfOutputs) -> Caution | None:
        """The table ends below the picture's Nyquist frequency, before the MTF is zero."""
        grid = context.grid
        for law, scale, nyquist in _ends(outputs.mtf.factors, grid.nyquist_x, grid.nyquist_y):
            frequencies, values = _points(law)
            last = frequencies[-1] / scale
            if values[-1] > ENDS_LOW and last < nyquist:
                return Caution(
                    "higher frequencies are lost: the MTF is "
                    f"{values[-1]:.3g} where the table ends ({last:.4g} cyc/mrad), and 0 from "
                    f"there to the picture's Nyquist frequency ({nyquist:.4g} cyc/mrad)",
                    "extend the table until the MTF is 0",
                )
        return None

    @warning
    def above_one(self, outputs: OtfOutputs) -> Caution | None:
        """The MTF rises above 1, like the MTF of a sharpened picture."""
        highest = max(
            (max(_points(law)[1]) for law, _, _ in _ends(outputs.mtf.factors, 0.0, 0.0)),
            default=0.0,
        )
        if highest <= 1.0 + physics.ROUNDED:
            return None
        return Caution(
            f"the picture is sharpened: the MTF rises to {highest:.4g}, but optics "
            "have an MTF of at most 1",
            "check the table; measure the MTF in pictures that are not sharpened",
        )

    no_phase = context_defaults.phase_warning
    geometry = context_defaults.context_warning(
        "The pitch or focal length differs from the value on Init & Trans.",
        "focal_length_mm detector_x_um detector_y_um",
        where=context_defaults.ELECTRONICS,
    )

    @readout("cyc/mrad")
    def end_x(self, axis: str, outputs: OtfOutputs) -> float | None:
        """Highest frequency in the file's horizontal MTF."""
        for factor in outputs.mtf.factors:
            if isinstance(factor, Planar):
                return None if factor.cutoff is None else factor.cutoff["xy".index(axis)]
            law = factor.x if axis == "x" else factor.y
            return None if law is None else _points(law)[0][-1] / law.scale
        return None


def _points(law: Law) -> tuple[physics.Column, physics.Column]:
    bound = dict(law.parameters)
    return bound["frequencies"], bound["values"]


def _ends(
    factors: tuple[Factor, ...], nyquist_x: float, nyquist_y: float
) -> Iterator[tuple[Law, float, float]]:
    """The laws across and along, what scales their frequencies, and how far the picture's go."""
    for factor in factors:
        if isinstance(factor, Planar):
            corner = math.hypot(nyquist_x, nyquist_y * factor.ratios[1])
            yield factor.law, factor.law.scale, corner
        else:
            for law, nyquist in ((factor.x, nyquist_x), (factor.y, nyquist_y)):
                if law is not None:
                    yield law, law.scale, nyquist


# A lens' file that a network names: found, described and read in the state it was planned with.
#
# A picture of any kind, an array, complex too, or a listing: a matrix of numbers in text, below the
# lines of words that optical design programs write.

LARGEST_SIDE = 8192
_TEXTS = (*CSV.suffixes, *BLANKS.suffixes, ".dat")
_GRID = re.compile(r"(?:pupil|image) grid size:?\s*(\d+)\s*by\s*(\d+)", re.IGNORECASE)
_NUMBER = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[Ee][-+]?\d+)?)"
_LENGTH = r"(nm|µm|μm|um|microns?|micrometers?|mm|millimeters?)"
_SHORT = r"(nm|µm|μm|um|microns?|micrometers?)"
# As Zemax has it, at the start of a line: other lengths may be "at" something too.
_WAVELENGTH = re.compile(
    rf"^\s*{_NUMBER}\s*{_SHORT}\s+at\b|\bwavelength:?\s*{_NUMBER}\s*{_SHORT}", re.IGNORECASE
)
_SPACING = re.compile(rf"data spacing is\s+{_NUMBER}\s*{_LENGTH}", re.IGNORECASE)
_MICROMETRES = {"nm": 1e-3, "mm": 1e3, "millimeter": 1e3, "millimeters": 1e3}


@dataclass(frozen=True)
class LensSource:
    """A file with what is known of it, in a listing's header too; `reading` goes into a step."""

    file: Path
    stamps: tuple[Stamp, ...]
    band: int
    rows: int
    columns: int
    bands: int = 1
    is_complex: bool = False
    wavelength_um: float | None = None
    spacing_um: float | None = None

    @property
    def reading(self) -> dict[str, Any]:
        """Arguments of `stored_samples`, by which the file's state enters a step's key."""
        return {"file": self.file, "stamps": self.stamps, "band": self.band}


def lens_source(path: Path, here: NodeContext, *, band: int = 0) -> LensSource:
    file = readable_file((here.folder / path).absolute())
    return _described(file, stamps_of(file, header_beside(file)), band)


@lru_cache(maxsize=64)
def _described(file: Path, stamps: tuple[Stamp, ...], band: int) -> LensSource:
    bands, more = 1, dict[str, Any]()
    if _is_listing(file):
        matrix, more["wavelength_um"], more["spacing_um"] = read_listing(file)
        shape: tuple[int, ...] = matrix.shape
    elif is_npy(file) and npy_header(file).dtype.kind == "c":
        shape, more["is_complex"] = npy_header(file).shape, True
        if len(shape) != 2 or 0 in shape:
            raise FileError(
                f"{file}: contains a complex array of shape {shape}; allowed: (rows, columns)"
            )
    else:
        info = read_info(file)
        shape, bands = (info.rows, info.columns), info.bands
    checked_band(band, bands, file)
    rows, columns = shape
    if max(shape) > LARGEST_SIDE:
        raise FileError(
            f"{file}: {columns} × {rows} samples; at most {LARGEST_SIDE} on a side are "
            "allowed: crop the array around its middle"
        )
    return LensSource(file, stamps, band, rows, columns, bands, **more)


def stored_samples(*, file: Path, stamps: tuple[Stamp, ...], band: int) -> NDArray[Any]:
    """Samples, row 0 at the top: float64, or complex128; some may be not finite."""
    check_unchanged(file, stamps)
    if _is_listing(file):
        return read_listing(file)[0]
    if _described(file, stamps, band).is_complex:
        return whole_npy(file).astype(np.complex128, order="C")
    return np.asarray(read_pixels(file, band), np.float64)


def _is_listing(path: Path) -> bool:
    return path.suffix.lower() in _TEXTS and not is_npy(path)


def _length_um(header: list[str], pattern: re.Pattern[str]) -> float | None:
    for match in filter(None, map(pattern.search, header)):
        number, unit = (group for group in match.groups() if group is not None)
        return float(number) * _MICROMETRES.get(unit.lower(), 1.0)
    return None


def read_listing(path: Path) -> tuple[NDArray[np.float64], float | None, float | None]:
    """Read a text matrix, such as Zemax's wavefront map or PSF, perhaps below a header.

    The matrix, NaN where the text has it; then the wavelength and the spacing in µm, None where the
    header does not name it.
    """
    lines = [line.strip() for line in lens_lines(path, what="a matrix of numbers")]
    header: list[str] = []
    rows: list[NDArray[np.float64]] = []
    for number, line in enumerate(lines, 1):
        if not line:
            continue
        values = None if line.startswith("#") else numbers_of(filter(str.strip, cells_of(line)))
        if values is None and not rows:
            header.append(line)
        elif values is None:
            raise line_refused(path, number, f"{len(rows[0])} numbers, as in the rows above")
        elif rows and len(values) != len(rows[0]):
            raise FileError(
                f"{path}: line {number} has {len(values)} numbers; allowed: {len(rows[0])}, as in "
                "the rows above"
            )
        else:
            rows.append(np.array(values))  # a fifth of the memory of the tuple
    if not rows:
        raise FileError(f"{path}: contains no matrix of numbers")
    matrix = np.array(rows, np.float64)
    size = next((match for match in map(_GRID.search, reversed(header)) if match), None)
    # FFT listings name the grid of the pupil too: the last of them is that of the matrix.
    if size and (int(size[2]), int(size[1])) != matrix.shape:
        raise FileError(
            f"{path}: its header gives {size[1]} by {size[2]} samples, but the file has "
            f"{matrix.shape[1]} by {matrix.shape[0]}"
        )
    return matrix, _length_um(header, _WAVELENGTH), _length_um(header, _SPACING)
