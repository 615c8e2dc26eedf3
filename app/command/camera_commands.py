"""``imagechain measure``, ``fit``, ``photon-transfer`` and ``netd``: from a camera's pictures."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.command import options
from app.run import option_values as values
from app.run.terminal import Stop
from core.errors import in_line
from nodes.files.file_format import CSV, HTML, JSON

if TYPE_CHECKING:
    from app.fit.fit_result import FitResult
    from app.measure.picture_measurement import PictureMeasurement
    from app.run.overrides import GivenNetwork
    from core.evaluation.work import Policy


@options.command()
@options.argument(
    "pictures", "PICTURE...",
    "pictures in any format that Imagechain reads, or stacks of frames: .npy (frames, rows, "
    "columns), TIFF with one page per frame, or ENVI with one band per frame and no wavelengths",
    values.file_path, many=True,
)  # fmt: skip
@options.json_file("write all results as .json")
@options.option(
    "--csv", "FILE", "write the pooled MTF as a .csv table for the module MTF File",
    values.ending_in(CSV))  # fmt: skip
@options.option(
    "--report", "FILE", "write an .html page with the edges drawn on the picture",
    values.ending_in(HTML))  # fmt: skip
@options.option("--band", "N", "band or colour to measure (the first is 0)", values.whole_number)
@options.option(
    "--fov-x-deg", "DEG",
    "horizontal field of view, for frequencies in cycles/mrad (default: from the header)",
    values.finite_number)  # fmt: skip
@options.option(
    "--pitch-um", "UM", "pixel pitch of the detector, for frequencies in cycles/mm",
    values.finite_number)  # fmt: skip
@options.option(
    "--dark", "FILE", "dark frames with the exposure time of the pictures, for the read noise",
    values.file_path, group=options.RARER)  # fmt: skip
@options.option(
    "--offset-dn", "DN", "dark level, if there are no dark frames (default: 0)",
    values.finite_number, group=options.RARER)  # fmt: skip
def measure(
    stop: Stop,
    pictures: tuple[Path, ...],
    json: Path | bool | None,
    csv: Path | None,
    report: Path | None,
    dark: Path | None,
    **known: Any,
) -> None:
    """Measure MTF and noise in pictures of a camera.

    The camera may be real or simulated. The command finds usable edges, measures the MTF of each
    with its standard error (ISO 12233), and pools them into a horizontal and a vertical MTF. It
    says why other edges are not used. Noise is measured in flat areas. Several pictures, or files
    of frames, must have one size and come from one camera: their edges are pooled. If they show the
    same scene, the noise is split into time, rows and columns.

    A colour picture is measured by its luminance (0.2126 R + 0.7152 G + 0.0722 B of the stored
    numbers). If a picture has other bands, choose one with --band. Pictures with lossy
    compression, such as JPEG, give no figures. If a figure cannot be measured, the reason is
    printed instead. Photograph a straight edge between a dark and a bright area, tilted by about
    5°, without clipping, and store raw data. The handbook explains the procedure and the figures:
    imagechain handbook real_camera.

    Example: imagechain measure picture.tif --report measured.html --csv mtf.csv
    """
    from app.measure.measurement_page import measurement_facts, measurement_text
    from app.measure.measurement_text import figure_rows, frame_rows, refused_lines, remarks
    from app.measure.measuring import measure_files
    from app.run.terminal import columns

    inputs = [*pictures, *([dark] if dark is not None else [])]

    def made() -> PictureMeasurement:
        with options.Progress(len(inputs)) as progress:
            check = partial(options.check_stop, stop)
            return measure_files(pictures, dark=dark, check=check, report=progress, **known)

    outputs = [path for path in (json, csv, report) if isinstance(path, Path)]
    measured = options.written(outputs, inputs, stop, made, measurement_text)
    rows = [*figure_rows(measured), *frame_rows(measured)]
    lines = map(in_line, (*remarks(measured), *refused_lines(measured)))
    options.show(json, lambda: measurement_facts(measured), columns(rows, right=(1,)), *lines)


@options.command()
@options.network_options
@options.option(
    "--to", "PICTURE...",
    "one or more pictures from the camera, as linear raw data without lossy compression",
    values.file_path, several=True, many=True, required=True, to="pictures")  # fmt: skip
@options.option(
    "--free", "NODE.PARAM[=LOW:HIGH]...",
    "parameters to fit, each within its own range or a range that you give, such as "
    "jitter.sigma_mrad or optics.defocus_waves=0:2; may be repeated",
    several=True, many=True)  # fmt: skip
@options.json_file("write the parameters, their errors and correlations")
@options.option(
    "--output", "FILE", "write the network with the fitted values", values.ending_in(JSON)
)
@options.option(
    "--report", "FILE",
    "write an .html page with real and simulated patches side by side, overlaid edges and "
    "residuals",
    values.ending_in(HTML))  # fmt: skip
@options.option("--band", "N", "band or colour to fit to (the first is 0)", values.whole_number)
@options.numerical_options
def fit(
    stop: Stop,
    asked: GivenNetwork,
    policy: Policy,
    pictures: tuple[Path, ...],
    free: tuple[str, ...],
    json: Path | bool | None,
    output: Path | None,
    report: Path | None,
    band: int | None,
) -> None:
    """Fit parameters of a network to pictures of a camera.

    Ideal edges replace the network's source where the pictures have edges. The fit compares the
    edge spread that the chain predicts with the pictures' samples. You get every free parameter
    with its standard error. Each sample of the camera's picture must correspond to one sample of
    the network's final picture.

    First enter the camera's pitch and focal length in the network. If parameters have the same
    effect on the edges, only their combination is given. Ranges shorten the search. For details:
    imagechain handbook fitting.

    Example: imagechain fit mwir_camera --to picture.tif --free jitter.sigma_mrad=0:0.2
    optics.defocus_waves=0:1 --report fit.html --output fitted.json
    """
    from app.command.network_run import input_files
    from app.fit.chain_transfer import free_parameters
    from app.fit.fit_page import fit_content, fit_facts, fit_text
    from app.fit.picture_fit import fit_pictures, fitted_network, opened_pictures
    from core.chain.engine import Engine
    from core.editing.document import rebased
    from core.network.file import format_network

    library, place, network = options.opened(asked, bool(json))
    fitted_parameters = free_parameters(free, network, library)
    engine = Engine(library)
    plan = engine.plan(network, folder=place.folder)
    work = engine.work(policy, cancel=stop)

    def made() -> FitResult:
        with options.Progress(3) as progress:
            return fit_pictures(
                engine, plan, work, free=fitted_parameters,
                pictures=opened_pictures(pictures, band=band), report=progress,
            )  # fmt: skip

    def content(result: FitResult, path: Path) -> str:
        if path != output:
            name = network.name or place.name
            return fit_content(result, path, network=name, pictures=pictures)
        fitted = fitted_network(network, result, engine)
        typed = {(setting.node, setting.name) for setting in asked.settings}
        fitted = rebased(fitted, library, place.folder, path.parent, typed=typed)
        return format_network(fitted, library=library)

    files = [path for path in (json, output, report) if isinstance(path, Path)]
    inputs = [place.path, *pictures, *input_files(plan)]
    result = options.written(files, inputs, stop, made, content)
    options.show(json, lambda: fit_facts(result), fit_text(result))


@options.command()
@options.argument(
    "flats", "FILE...",
    "two or more frames of a flat field, one file per level: .npy (frames, rows, columns), TIFF "
    "with one page per frame, or ENVI with one band per frame",
    values.file_path, many=True)  # fmt: skip
@options.option(
    "--dark", "FILE",
    "two or more dark frames with the size and exposure time of the flat fields, for the "
    "offset, read noise and DSNU",
    values.file_path)  # fmt: skip
@options.option(
    "--offset-dn", "DN", "dark level, if there are no dark frames", values.finite_number
)
@options.written_outputs("write the figures and the data of each level", values.TRANSFERS)
@options.json_flag
def photon_transfer(
    stop: Stop,
    flats: tuple[Path, ...],
    dark: Path | None,
    offset_dn: float | None,
    outputs: tuple[Path, ...],
    json: bool,
) -> None:
    """Measure gain, read noise and full well from flat fields.

    The camera may be real or simulated. The photon transfer curve (Janesick 2007; EMVA 1288) is the
    temporal variance of the pixels against their mean. The inverse slope is the gain in electrons
    per digital number. The variance at the dark level, without rounding, gives the read noise. The
    level at which the variance collapses is the full well. The variance between pixels gives DSNU
    and PRNU. The command also prints the figures that EMVA 1288 defines differently: K (DN per
    electron), saturation capacity, sensitivity threshold, dynamic range, maximum SNR, and DSNU and
    PRNU of rows, columns and pixels.

    Take at least five levels of a uniform field, from near dark to beyond saturation, with at least
    ten frames each. Lamp flicker does no harm; pixels must not be clipped at 0. The line is fitted
    to levels up to 0.7 of saturation. If the field is not uniform, a warning says so: PRNU and DSNU
    then include the field's structure, while gain and read noise remain correct. Simulate each
    level with another --seed.

    Example: imagechain photon-transfer flat1.tif flat2.tif flat3.tif --dark dark.tif --output
    camera.json
    """
    from app.measure.uniform_fields import UniformFields, measured_transfer

    inputs = [*flats, *filter(None, [dark])]

    def made() -> UniformFields:
        with options.Progress(len(inputs)) as progress:
            check = partial(options.check_stop, stop)
            return measured_transfer(flats, dark, offset_dn, check=check, report=progress)

    measured = options.written(outputs, inputs, stop, made, UniformFields.content)
    options.show(json, lambda: measured.facts, *measured.lines())


@options.command()
@options.argument(
    "fields", "FILE=TEMPERATURE...",
    "one file per temperature, with two or more frames of a black body, and the temperature of "
    "the black body, such as 293.15K or 20C. Give two or more temperatures, corrected for "
    "emissivity and atmosphere. The file formats are the same as for photon-transfer",
    values.file_at_temperature, many=True)  # fmt: skip
@options.written_outputs("write the figures, overall and at each temperature", values.TRANSFERS)
@options.json_flag
def netd(
    stop: Stop, fields: tuple[tuple[Path, float], ...], outputs: tuple[Path, ...], json: bool
) -> None:
    """Measure SiTF, NETD and 3-D noise with black bodies.

    The camera may be real or simulated. Its frames show a black body that fills the field, at two
    or more temperatures. You get SiTF (digital numbers per kelvin) and NETD (noise divided by SiTF)
    with standard errors. At each temperature you also get the seven components of 3-D noise
    (D'Agostino and Webb 1991) in kelvin.

    Take at least 64 frames of each temperature, and at least three temperatures a few kelvin apart.
    Two temperatures give SiTF midway between them; three or more also show how it changes. NETD
    is the noise that is random in time, row and column (sigma_tvh). Noise of whole rows, columns
    and frames is listed separately and included in the total. Bad pixels are left out. Rounding is
    included. Drift slower than the sequence is counted as fixed pattern.

    Example: imagechain netd cold.tif=20C middle.tif=25C hot.tif=30C --output netd.json
    """
    from app.measure.uniform_fields import UniformFields, measured_netd

    def made() -> UniformFields:
        with options.Progress(2 * len(fields)) as progress:
            return measured_netd(fields, check=partial(options.check_stop, stop), report=progress)

    paths = [path for path, _ in fields]
    measured = options.written(outputs, paths, stop, made, UniformFields.content)
    options.show(json, lambda: measured.facts, *measured.lines())
