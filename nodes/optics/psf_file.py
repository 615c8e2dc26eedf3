"""PSF File: a point spread function, measured or of a lens design, from a picture."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

from core.chain.wires import Context, Magnitude, Phase
from core.errors import DataError, ParameterError
from core.evaluation.recipes import Step
from core.evaluation.work import Work
from core.modules.declaration import Caution, Formula, NodeContext, Section, param, readout, warning
from core.physics.optics.blur import PointSpread, coarseness, edge_share, sampled_psf_otf
from core.transfer.factors import Factor, Law, Planar
from nodes.files.formats import check_finite
from nodes.optics.mtf_file import LensSource, lens_source, stored_samples
from nodes.shared.context_defaults import apart_from_context, given, phase_warning
from nodes.shared.module_ports import Apply, NyquistReadouts, OtfOutputs, otf_outputs

EDGE_ENERGY = 0.01  # of the whole, above which the border is warned of
LARGEST_SIDE = 4096  # samples, whose sum is not fast
COARSE = 0.02  # MTF at the samples' Nyquist frequency, likewise


class PsfFile(NyquistReadouts, key="psf_file", title="PSF File", group="Optics"):
    """Blur with a point spread function from a file: measured, or from a lens design.

    Every point of the picture is spread into the PSF in the file. Row 0 is at the top, and a tail
    to the right in the file is a tail to the right in the picture. The file may have any format
    that Read Image reads, or be a `.npy` file, a text file or a Zemax listing. The spacing in a
    Zemax listing is used if `sample_pitch` is empty. Samples are divided by their sum. With
    `centroid` kept, the point is at the middle of the file, (n − 1)/2, which lies between samples
    for even sizes. A centroid elsewhere shifts the picture. With `centroid` removed nothing shifts.
    The OTF is the exact sum over the samples at the picture's own frequencies, for any pitch, and 0
    beyond the file's Nyquist frequency. A PSF measured with a detector includes the pixel: leave
    out Detector MTF. Without a file nothing changes. Source: Goodman 2005, Introduction to Fourier
    Optics, section 6.3.
    """

    formulas = (
        Formula(
            r"H(\xi,\eta)=\frac{\sum_{j,k}p_{jk}\,e^{-2\pi i(\xi x_k+\eta y_j)}}{\sum_{j,k}p_{"
            r"jk}}",
            where="p: samples of the file minus the background; x, y: their positions, mrad, "
            "from the middle (centroid kept) or from the centroid (removed)",
        ),
    )

    path: Path | None = param(
        None, "PSF file, relative to the network file's folder; empty: no blur"
    )
    band: int | None = param(
        None, "band or channel to read, counted from 0", low=0, zero_is_empty=False
    )
    sample_pitch: float | None = param(
        None,
        "horizontal sampling interval of the file, in `pitch_unit`; empty: from the file",
        low=0,
        slider=(0.1, 20),
    )
    sample_pitch_y: float | None = param(
        None,
        "vertical sampling interval of the file; empty: equal to sample_pitch",
        low=0,
        slider=(0.1, 20),
    )
    pitch_unit: Literal["um", "mrad"] = param(
        "um", "unit of both sampling intervals: µm at the focal plane, or mrad"
    )
    focal_length_mm: float | None = param(
        None,
        "focal length, used if pitch_unit is um; empty: from Init & Trans",
        low=0,
        slider=(10, 10000),
    )
    centroid: Literal["kept", "removed"] = param(
        "kept",
        "offset of the centroid from the array's centre: kept (it shifts the picture), or removed",
    )
    background: float = param(
        0.0, "background to subtract from every sample, in the file's unit", slider=(0, 100)
    )
    apply: Apply = "multiply"

    panel = (
        Section("File", "path band background"),
        Section("Samples", "sample_pitch sample_pitch_y pitch_unit centroid"),
        Section("", "focal_length_mm", shown_when=("pitch_unit", ("um",))),
        Section("Output", "apply"),
    )

    def run(
        self, context: Context, magnitude: Magnitude, here: NodeContext, phase: Phase | None = None
    ) -> OtfOutputs:
        blur: tuple[Factor, ...] = ()
        shift: tuple[Factor, ...] = ()
        if self.path is not None:
            source = lens_source(self.path, here, band=self.band or 0)
            if self.band is None and source.bands > 1:
                allowed = (
                    f"the file {source.file.name} has {source.bands} bands; choose 0 to "
                    f"{source.bands - 1}"
                )
                raise ParameterError("band", None, allowed)
            blur, shift = self._factors(source, context, here)
        return otf_outputs(self.apply, magnitude, phase, blur=blur, shift=shift, label=self.title)

    def _factors(
        self, source: LensSource, context: Context, here: NodeContext
    ) -> tuple[tuple[Planar], tuple[Planar]]:
        if source.is_complex:
            raise DataError(
                f"{source.file}: a point spread function must be real, but the file "
                "contains complex numbers"
            )
        rows, columns = source.rows, source.columns
        if max(rows, columns) > LARGEST_SIDE:
            raise DataError(
                f"{source.file}: {columns} × {rows} samples; at most {LARGEST_SIDE} on a side "
                "are allowed: crop the picture around the point"
            )
        x, y = self._pitches(source, context)
        psf = here.step(
            _point_spread,
            background=self.background,
            keep_centroid=self.centroid == "kept",
            **source.reading,
        )
        law = Law.of(sampled_psf_otf, psf=psf, pitch_x_mrad=x, pitch_y_mrad=y)
        how: dict[str, Any] = {"symmetric": False, "cutoff": (0.5 / x, 0.5 / y)}
        how |= {"label": self.title, "node": here.node}
        return (Planar(law, take="modulus", **how),), (Planar(law, take="phase", **how),)

    def _pitches(self, source: LensSource, context: Context) -> tuple[float, float]:
        across, unit = self.sample_pitch, self.pitch_unit
        if across is None:
            across, unit = source.spacing_um, "um"
        if across is None:
            allowed = (
                f"the file {source.file.name} does not state its sampling interval; give the "
                "interval in µm at the focal plane or in mrad"
            )
            raise ParameterError("sample_pitch", None, allowed)
        along = across if self.sample_pitch_y is None else self.sample_pitch_y
        if unit == "mrad":
            return across, along
        focal_length = given("focal_length_mm", self.focal_length_mm, context)
        return across / focal_length, along / focal_length

    @warning
    def no_file(self) -> Caution | None:
        """No file is given, so the module does nothing."""
        if self.path is not None:
            return None
        return Caution("nothing is blurred: path is empty", "give the path of a PSF file")

    @warning
    def border(self, outputs: OtfOutputs) -> Step | None:
        """Energy is cut off at the file's border, or the file has a background."""
        return _of_psf(_border_caution, outputs)

    @warning
    def coarse(self, outputs: OtfOutputs) -> Step | None:
        """The file's samples are too far apart."""
        return _of_psf(_coarse_caution, outputs)

    no_phase = phase_warning

    @warning
    def geometry(self, context: Context) -> Caution | None:
        """The focal length differs from the value on Init & Trans."""
        if self.pitch_unit != "um":
            return None
        return apart_from_context(self, context, "focal_length_mm")

    @readout("mrad")
    def centre_x_mrad(self, outputs: OtfOutputs) -> Step | None:
        """Horizontal offset of the centroid from the array's centre, positive to the right."""
        return _centroid(outputs, 1)

    @readout("mrad")
    def centre_y_mrad(self, outputs: OtfOutputs) -> Step | None:
        """Vertical offset of the centroid from the array's centre, positive downwards."""
        return _centroid(outputs, 0)

    @readout()
    def sum_of_samples(self, outputs: OtfOutputs) -> Step | None:
        """Sum of the file's samples minus the background; the samples are divided by this sum."""
        return _of_psf(_total, outputs)

    @readout("cyc/mrad")
    def file_nyquist_x(self, outputs: OtfOutputs) -> float | None:
        """Horizontal Nyquist frequency of the file's samples, beyond which the MTF is 0."""
        factors = outputs.mtf.factors
        return factors[0].cutoff[0] if factors else None  # type: ignore[union-attr, index]


def _bound(outputs: OtfOutputs) -> dict[str, Any]:
    laws = (law for factor in outputs.mtf.factors for law in factor.laws)
    return {name: value for law in laws for name, value in law.parameters}


def _of_psf(function: Callable[..., Any], outputs: OtfOutputs) -> Step | None:
    bound = _bound(outputs)
    return Step.of(function, bound["psf"]) if bound else None


def _centroid(outputs: OtfOutputs, axis: int) -> Step | None:
    bound = _bound(outputs)
    if not bound:
        return None
    pitch = bound["pitch_x_mrad" if axis == 1 else "pitch_y_mrad"]
    return Step.of(_centroid_mrad, bound["psf"], axis=axis, pitch_mrad=pitch)


def _point_spread(
    work: Work, *, background: float, keep_centroid: bool, file: Path, **reading: Any
) -> PointSpread:
    samples = stored_samples(file=file, **reading)
    check_finite(samples, str(file))
    try:
        return PointSpread.of(samples, background=background, keep_centroid=keep_centroid)
    except DataError as error:
        raise DataError(f"{file}: {error.message}") from error


def _centroid_mrad(work: Work, psf: PointSpread, *, axis: int, pitch_mrad: float) -> float:
    place = psf.centroid_column if axis == 1 else psf.centroid_row
    return float(pitch_mrad * (place - (psf.weights.shape[axis] - 1) / 2))


def _total(work: Work, psf: PointSpread) -> float:
    return psf.total


def _border_caution(work: Work, psf: PointSpread) -> Caution | None:
    share = edge_share(psf)
    if share <= EDGE_ENERGY:
        return None
    return Caution(
        "the blur may be wrong: the samples at the border of the file are not near 0; a "
        f"pedestal of that height would contain {100 * share:.3g} % of the energy",
        "subtract the background, or use a larger picture of the point, so that nothing is cut off",
    )


def _coarse_caution(work: Work, psf: PointSpread) -> Caution | None:
    rest = coarseness(psf)
    if rest <= COARSE:
        return None
    return Caution(
        "the file's samples are too far apart: at their own Nyquist frequency the MTF is still "
        f"{rest:.3g}",
        "use a more finely sampled picture of the point: detail between samples is aliased",
    )
