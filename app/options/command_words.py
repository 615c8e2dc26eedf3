"""The words of each command: their help, and what reads the text behind them."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from app.options.option_values import (
    OUTPUTS,
    REPORTS,
    STUDIES,
    SUMMARIES,
    TRANSFERS,
    assignment,
    ending_in,
    file_at_temperature,
    file_path,
    finite_number,
    report_path,
    save_target,
    size_in_bytes,
    study_path,
    summary_path,
    tolerance,
    whole_number,
    window_size,
)
from core.modules.parameters import LARGEST_INTEGER
from nodes.files.common.file_format import CSV, HTML, JSON, PNG, suffixes

SAVED = "SAVED"  # in a help, for the suffixes of what a port can be saved as
BENCH_PARTS = ("speed", "precision", "peers", "studies", "measure")
SCREENSHOT_PARTS = ("window", "canvas", "panel", "curves", "picture")
Parser = argparse.ArgumentParser
Read = Callable[[str, str], Any]


class Word(argparse.Action):
    """A word that may be given once, or `many` times; `read` makes a value of its text later."""

    def __init__(self, *, read: Read | None = None, many: bool = False, **how: Any) -> None:
        super().__init__(default=argparse.SUPPRESS, **how)
        self.many = many
        self._read = read or (lambda _, text: text)

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: str | Sequence[Any] | None,
        option_string: str | None = None,
    ) -> None:
        given: dict[Word, Any] = vars(namespace).setdefault("given", {})
        if self.many:
            given.setdefault(self, []).extend(values if isinstance(values, list) else [values])
        elif self in given:
            parser.error(f"{option_string} is given more than once")
        else:
            given[self] = values

    def value(self, command: str, given: Any) -> Any:
        option = self.option_strings[0] if self.option_strings else command
        if isinstance(given, list):
            return tuple(self._read(option, text) for text in given)
        return self._read(option, given) if isinstance(given, str) else True


def _add(
    parser: Any, name: str, metavar: str | tuple[str, str], about: str, read: Read | None = None,
    **how: Any,
) -> None:  # fmt: skip
    parser.add_argument(name, action=Word, metavar=metavar, help=about, read=read, **how)


def _flag(parser: Parser, name: str, about: str, **how: Any) -> None:
    parser.add_argument(name, action="store_true", help=about, **how)


def _network_words(parser: Parser) -> None:
    _add(parser, "network", "NETWORK", "a network file, or the name of an example network")
    _add(parser, "--set", "NODE.PARAM=VALUE",
         "change a parameter for this run; null clears it; may be repeated",
         partial(assignment, form="NODE.PARAM=VALUE"), many=True, dest="settings")  # fmt: skip
    _add(parser, "--disable", "NODE",
         "switch a node off for this run: it passes on its input; may be repeated",
         many=True, dest="disabled")  # fmt: skip
    _add(parser, "--final", "NODE.PORT",
         "use this picture as the network's output, instead of the one marked in the file",
    )  # fmt: skip
    add = partial(_add, parser.add_argument_group("a picture of your own"))
    add("--scene", "[NODE=]FILE",
        "use this picture or cube as the scene; NODE chooses among several scenes",
        _scene, many=True, dest="scenes")  # fmt: skip
    add("--scene-fov-deg", ("X", "Y"),
        "its field of view (default: from its header, else as wide as the old scene)",
        finite_number, nargs=2)  # fmt: skip
    add("--scene-range-m", "M", "its distance", finite_number)
    add("--scene-sample-m", "M", "size of a sample in the scene, instead of the field of view",
        finite_number)  # fmt: skip
    add("--scene-band-um", ("A", "B"),
        "its wavelength band (default: from its header, else as for the old scene)",
        finite_number, nargs=2)  # fmt: skip
    add("--scene-unit", "UNIT",
        "its unit: a radiance unit, K, C, reflectance, or relative (scaled to the range of "
        "the old scene); default: the file's unit, else relative")  # fmt: skip


def _scene(option: str, text: str) -> str:
    file_path(option, text)
    return text


def _place_words(parser: Parser) -> None:
    _add(parser, "--output-dir", "DIR",
         "folder for final.png, mtf.csv and readouts.json (default ./NAME-output)", file_path,
    )  # fmt: skip
    _add(parser, "--allow-writes-to", "DIR",
         "let the network's nodes write and replace any file below DIR. By default they write only "
         "to the network's folder and the output folder, and replace only files that this "
         "network has written. May be repeated", file_path, many=True, dest="allowed")  # fmt: skip


def _numerical_words(parser: Parser) -> None:
    parser.add_argument("--precision", action=Word, choices=("single", "double"),
                        help="default: single")  # fmt: skip
    _add(parser, "--tolerance", "T",
         "error budget, 0 to below 1: leave out stages that together change the picture by less "
         "than this fraction of its range. Default: below the precision's rounding; 1e-4 of each "
         "band's contrast if a few wavelengths represent all bands. 0 leaves out only what "
         "changes nothing", tolerance)  # fmt: skip
    _add(parser, "--seed", "N", "seed of the noise, instead of the network's",
         partial(whole_number, largest=LARGEST_INTEGER))  # fmt: skip
    _add(parser, "--threads", "N", "worker threads (default: all)",
         partial(whole_number, largest=1024))  # fmt: skip


def _edit_words(parser: Parser) -> None:
    add = partial(_add, parser)
    add("network", "NETWORK", "a network file, or the name of an example network", nargs="?")
    add("--screenshot", "FILE", "save the window as .png and exit; needs no display",
        ending_in(PNG))  # fmt: skip
    parser.add_argument("--part", action=Word, choices=SCREENSHOT_PARTS,
        help="window (default), canvas, panel, curves, or the first viewer's picture within --size",
    )  # fmt: skip
    add("--size", "WxH",
        "size of the window (default: the last size; at the first start, to fit the screen; "
        "screenshot: 1600x900)",
        window_size, dest="window_size")  # fmt: skip
    parser.add_argument("--look", action=Word, choices=("dark", "light"),
                        help="colours (default: those used last)")  # fmt: skip


def _run_words(parser: Parser) -> None:
    _network_words(parser)
    add = partial(_add, parser)
    add("--save", "NODE.PORT=FILE",
        f"write the value of a port, as {SAVED}. NODE.PORT[TOP:BOTTOM,LEFT:RIGHT]=FILE writes "
        "part of an image: these rows and columns, counted from 0, without BOTTOM and RIGHT "
        "themselves (default: the image's bounds). .bsq and .img (ENVI) keep all bands of an "
        "image; .zarr takes a picture of any size. May be repeated",
        _save, many=True, dest="saves")  # fmt: skip
    add("--frames", "N",
        "save N frames of each image, each with its own temporal noise; the first is the "
        "picture. Formats: .npy (frames, rows, columns), .tif .tiff (one page each), .bsq .img "
        "(ENVI, one band each)", whole_number)  # fmt: skip
    _place_words(parser)
    _flag(parser, "--all", "print the read-outs of all nodes instead of the main figures")
    add("--memory", "SIZE",
        "memory for pictures, such as 2GB or 500MB (default: half of what the process may "
        "use). A network that needs more runs in blocks, with its pictures on disk; the results "
        "are the same", size_in_bytes, dest="memory_bytes")  # fmt: skip
    add("--scratch", "DIR",
        "folder for pictures that do not fit into memory (default: beside the output)", file_path,
    )  # fmt: skip
    add("--report", "FILE", f"write a report, {' or '.join(suffixes(*REPORTS))}; may be repeated",
        report_path, many=True, dest="reports")  # fmt: skip
    _numerical_words(parser)


def _save(_option: str, text: str) -> Any:
    return save_target(text)


def _check_words(parser: Parser) -> None:
    _network_words(parser)
    _place_words(parser)


def _tradeoff_words(parser: Parser) -> None:
    _network_words(parser)
    add = partial(_add, parser)
    add("--vary", "NODE.PARAM=VALUES",
        "parameter to vary: FROM:TO:COUNT, FROM:TO:COUNT:log (equal factors), or values a,b,c; "
        "if given twice, each value of the second makes a curve",
        many=True, required=True)  # fmt: skip
    add("--figure", "NODE.READOUT",
        "figure to compute: a read-out of a node, or an MTF of the chain. total.mtf_nyquist_x "
        "and total.mtf_half_nyquist_x (or _y) are at the samples' Nyquist frequency and half of "
        "it, total.mtf_pixel_nyquist_x and total.mtf_half_pixel_nyquist_x at the pixels'. May be "
        "repeated (default: the electronics' figures and the chain's MTFs, if they change)",
        many=True, dest="figures")  # fmt: skip
    add("--output", "FILE",
        f"write the figures, as {' '.join(suffixes(*OUTPUTS))}; may be repeated",
        ending_in(*OUTPUTS), many=True, dest="outputs")  # fmt: skip
    _numerical_words(parser)


def _study_words(parser: Parser) -> None:
    parser.description = (
        "Evaluate a network at every point of a grid, a Latin hypercube or a list, for every "
        "picture that matches a pattern. Each point becomes a row: its values, its figures, a key "
        "of the computation, its computing time, and the reason if it failed. To resume a study "
        "that was stopped or killed, give the same command again; finished rows are saved in "
        "OUTPUT.journal."
    )
    _network_words(parser)
    add = partial(_add, parser)
    add("--vary", "NODE.PARAM=VALUES",
        "parameter to vary: FROM:TO:COUNT, FROM:TO:COUNT:log (equal factors), or values a,b,c; "
        "with --sample latin, FROM:TO or FROM:TO:log; may be repeated", many=True)  # fmt: skip
    add("--over", "NODE.PARAM=PATTERN",
        "compute every point for each file that matches a pattern, such as "
        "scene.path='scenes/*.img', in numerical order; may be repeated", many=True)  # fmt: skip
    add("--sample", "HOW",
        "grid: all combinations of the values (default); latin: --points N points of a Latin "
        "hypercube, drawn with the network's seed; a .csv file: its rows, with columns named "
        "NODE.PARAM",
    )  # fmt: skip
    add("--points", "N", "number of points to draw", whole_number)
    add("--figure", "NODE.READOUT",
        "figure to compute at each point, as for tradeoff; may be repeated (default: figures of "
        "the electronics and the chain's MTF; none if pictures are saved)", many=True,
        dest="figures")  # fmt: skip
    add("--save", "NODE.PORT=PATTERN",
        "save each point's picture or curve. Fields in the file's name: {point}, {NODE.PARAM} "
        "of a varied parameter, {scene} for the name of the picture. Formats: "
        f"{SAVED}. May be repeated", _save, many=True, dest="saves",
    )  # fmt: skip
    add("--jobs", "N",
        "number of processes on this machine (default: one; all cores if the remaining points "
        "take long enough)", whole_number)  # fmt: skip
    add("--memory", "SIZE",
        "memory for computed values in all processes together, such as 2GB (default: 256MB in "
        "each process); give it for pictures larger than about 4000 x 4000 samples",
        size_in_bytes, dest="memory_bytes")  # fmt: skip
    add("--scheduler", "ADDRESS",
        "compute on the workers of a Dask scheduler, such as tls://10.0.0.1:8786; the workers "
        "need Imagechain and must see the same files")  # fmt: skip
    for name, what in (
        ("--tls-ca-file", "certificate of the authority"),
        ("--tls-cert", "certificate"),
        ("--tls-key", "private key"),
    ):
        add(name, "FILE", f"{what} for a scheduler at tls://")
    add("--output", "FILE", f"file for the rows, as {' '.join(suffixes(*STUDIES))}", study_path,
        required=True)  # fmt: skip
    add("--summary", "FILE",
        f"plot of the figures, as {' '.join(suffixes(*SUMMARIES))}; may be repeated",
        summary_path, many=True, dest="summaries")  # fmt: skip
    _flag(parser, "--fresh", "discard the rows of an unfinished study")
    _numerical_words(parser)


def _solve_words(parser: Parser) -> None:
    _network_words(parser)
    add = partial(_add, parser, required=True)
    add("--for", "NODE.PARAM[=LOW:HIGH]",
        "the parameter to find, in its own range or the one you give", dest="solve_for",
    )  # fmt: skip
    add("--until", "NODE.READOUT=VALUE",
        "the read-out, and the value you want, in the read-out's unit")  # fmt: skip
    _numerical_words(parser)


def _measure_words(parser: Parser) -> None:
    parser.description = (
        "Measure MTF and noise in pictures of a camera, real or simulated. The command finds "
        "usable edges, measures the MTF of each with its standard error (ISO 12233), and pools "
        "them into a horizontal and a vertical MTF. It says why other edges are not used. Noise "
        "comes from flat areas. Several pictures of one size, or files of frames, must come from "
        "one camera: their edges are pooled. If they show the same scene, the noise is split into "
        "time, rows and columns."
    )
    parser.epilog = (
        "A colour picture is measured by its luminance (0.2126 R + 0.7152 G + 0.0722 B of the "
        "stored numbers). If a picture has other bands, choose one with --band. A picture with "
        "lossy compression, such as JPEG, gives no figures. If a figure cannot be measured, the "
        "reason is printed instead. Photograph a straight edge between a dark and a bright area, "
        "turned by about 5° and not clipped, and store raw numbers. For how to do it, and what "
        "the figures mean: imagechain handbook real_camera. "
        "Example: imagechain measure picture.tif --report measured.html --csv mtf.csv"
    )
    add = partial(_add, parser)
    add("pictures", "PICTURE",
        "a picture in any format that Imagechain reads, or frames: .npy (frames, rows, "
        "columns), TIFF with a page per frame, or ENVI with bands without wavelengths",
        file_path, nargs="+")  # fmt: skip
    _json(parser, "write all results as .json")
    add("--csv", "FILE", "write the pooled MTF as a .csv table for the module MTF File",
        ending_in(CSV))  # fmt: skip
    add("--report", "FILE", "write an .html page with the edges drawn on the picture",
        ending_in(HTML))  # fmt: skip
    add("--band", "N", "band or colour to measure, counted from 0", whole_number)
    add("--fov-x-deg", "DEG",
        "horizontal field of view, for frequencies in cycles/mrad (default: from the header)",
        finite_number)  # fmt: skip
    add("--pitch-um", "UM",
        "pixel pitch of the detector, for frequencies in cycles/mm", finite_number,
    )  # fmt: skip
    add("--flats", "FILE",
        "frames of flat fields, one file per level, for the photon transfer curve (see "
        "imagechain photon-transfer --help)", file_path, nargs="+", many=True)  # fmt: skip
    add("--dark", "FILE", "frames without light, with the same exposure, for the read noise",
        file_path)  # fmt: skip
    add("--offset-dn", "DN", "dark level, if there are no dark frames (default: 0)",
        finite_number)  # fmt: skip


def _fit_words(parser: Parser) -> None:
    parser.description = (
        "Fit parameters of a network to pictures from a real camera. Ideal edges replace the "
        "network's source where the pictures have edges. The fit compares the edge spread that the "
        "chain predicts with the pictures' samples. You get every free parameter with its standard "
        "error. One sample of a picture is one sample of the network's final picture."
    )
    parser.epilog = (
        "First enter pitch and focal length of the camera in the network. For parameters with the "
        "same effect on the edges, only their combination is given. Ranges shorten the search. "
        "imagechain handbook fitting explains it. Example: imagechain fit mwir_camera "
        "--to picture.tif --free jitter.sigma_mrad=0:0.2 optics.defocus_waves=0:1 --report "
        "fit.html --output fitted.json"
    )
    _network_words(parser)
    add = partial(_add, parser)
    add("--to", "PICTURE",
        "one or more pictures from the camera, with linear raw numbers and no lossy "
        "compression", file_path, nargs="+", required=True, dest="pictures")  # fmt: skip
    add("--free", "NODE.PARAM[=LOW:HIGH]",
        "parameter to fit, in its own range or the one you give, such as jitter.sigma_mrad or "
        "optics.defocus_waves=0:2; may be repeated", nargs="+", many=True,
    )  # fmt: skip
    _flag(parser, "--known-scene",
          "the network's source is the scene that the camera saw: fit the whole picture",
    )  # fmt: skip
    add("--band", "N", "band or colour to fit to, counted from 0", whole_number)
    _json(parser, "write parameters, errors and correlations")
    add("--output", "FILE", "write the network with the fitted values", ending_in(JSON))
    add("--report", "FILE",
        "write an .html page of the fit: patches side by side, edges overlaid, residuals",
        ending_in(HTML))  # fmt: skip
    _numerical_words(parser)


def _photon_transfer_words(parser: Parser) -> None:
    parser.description = (
        "Measure a camera, real or simulated, by its photon transfer curve (Janesick 2007; EMVA "
        "1288): the temporal variance of the pixels against their mean. The inverse slope is the "
        "gain in electrons per digital number. The variance at the dark level, less rounding, "
        "gives the read noise. The level at which the variance collapses is the full well. The "
        "variance between pixels gives DSNU and PRNU. The command also prints the figures that "
        "EMVA 1288 defines differently: K (DN per electron), saturation capacity, sensitivity "
        "threshold, dynamic range, maximum SNR, and DSNU and PRNU of rows, columns and pixels."
    )
    parser.epilog = (
        "Take at least five levels of a uniform field, from near dark to beyond saturation, with "
        "at least ten frames each. Lamp flicker does no harm; pixels must not be clipped at 0. "
        "Levels up to 0.7 of saturation define the line. If the field is not uniform, a warning "
        "says so: PRNU and DSNU then include its structure, while gain and read noise stay right. "
        "Simulate each level with another --seed. Example: imagechain photon-transfer "
        "flat1.tif flat2.tif flat3.tif --dark dark.tif --output camera.json"
    )
    add = partial(_add, parser)
    add("flats", "FILE",
        "two or more frames of a flat field, one file per level: .npy (frames, rows, "
        "columns), TIFF with a page per frame, or ENVI with a band per frame",
        file_path, nargs="+")  # fmt: skip
    add("--dark", "FILE",
        "two or more frames without light, with the same size and exposure, for offset, read "
        "noise and DSNU", file_path)  # fmt: skip
    add("--offset-dn", "DN", "dark level, if there are no dark frames",
        finite_number)  # fmt: skip
    add("--output", "FILE",
        f"write the figures and the levels, as {' '.join(suffixes(*TRANSFERS))}; may be "
        "repeated", ending_in(*TRANSFERS), many=True, dest="outputs")  # fmt: skip


def _netd_words(parser: Parser) -> None:
    parser.description = (
        "Measure an infrared camera, real or simulated, from frames of a black body that fills "
        "the field at two or more temperatures. You get SiTF (digital numbers per kelvin) and NETD "
        "(noise divided by SiTF) with standard errors. At each temperature you also get the seven "
        "components of 3-D noise (D'Agostino and Webb 1991) in kelvin."
    )
    parser.epilog = (
        "Take at least 64 frames of each temperature, and at least three temperatures a few kelvin "
        "apart. Two give SiTF midway between them, three also its change. NETD is the noise that "
        "is random in time, row and column (sigma_tvh). Noise of whole rows, columns and frames is "
        "listed separately, and included in the total. Bad pixels are left out. Rounding is "
        "included. Drift slower than the sequence is counted as fixed pattern. "
        "Example: imagechain netd cold.tif=20C middle.tif=25C "
        "hot.tif=30C --output netd.json"
    )
    add = partial(_add, parser)
    add("fields", "FILE=TEMPERATURE",
        "two or more frames of a black body, and its temperature, such as 293.15K or 20C. Correct "
        "the temperature for emissivity and air. Formats as for photon-transfer",
        file_at_temperature, nargs="+")  # fmt: skip
    add("--output", "FILE",
        "write the figures, including those of each temperature, as "
        f"{' '.join(suffixes(*TRANSFERS))}; may be repeated", ending_in(*TRANSFERS), many=True,
        dest="outputs")  # fmt: skip


def _modules_words(parser: Parser) -> None:
    _add(parser, "key", "KEY|WORD",
         "only this module, or modules with this word in their key, title or summary", nargs="?",
    )  # fmt: skip


def _presets_words(parser: Parser) -> None:
    _add(parser, "word", "WORD", "only presets with this word in their name, text or module",
         nargs="?",
    )  # fmt: skip


def _handbook_words(parser: Parser) -> None:
    _add(parser, "word", "WORD", "a module, a page, or a word on a page", nargs="?")
    _add(parser, "--html", "DIR",
         "write the pages to a new folder, or over an older handbook, and do not open them",
        file_path,
    )  # fmt: skip
    _flag(parser, "--path", "print the path of the page, and do not open it")


def _bench_words(parser: Parser) -> None:
    _json(parser, "write every figure, for programs", file_path)
    _add(parser, "--html", "FILE", "write a page with tables and plots", file_path)
    _flag(parser, "--quick", "use fewer repetitions and sizes")
    _add(parser, "--only", "PART", "measure this part: " + ", ".join(BENCH_PARTS), many=True,
         choices=BENCH_PARTS)  # fmt: skip
    _add(parser, "--size", "N", "side of the picture in samples (default: 1024)",
         whole_number)  # fmt: skip


def _json(parser: Parser, about: str, read: Read | None = None) -> None:
    """``--json`` of a command that writes JSON to a file, too."""
    _add(parser, "--json", "FILE", f"{about}; without FILE, print the JSON alone",
         read or ending_in(JSON), nargs="?")  # fmt: skip


COMMANDS: dict[str, tuple[str, Callable[[Parser], None]]] = {
    "edit": ("open the editor", _edit_words),
    "run": ("compute a network's picture and figures", _run_words),
    "check": ("print the errors and warnings of a network", _check_words),
    "tradeoff": ("plot figures against a parameter", _tradeoff_words),
    "study": ("compute figures and pictures at many points, for many scenes", _study_words),
    "solve": ("find the parameter value that gives a read-out the value you want", _solve_words),
    "measure": ("measure MTF and noise in pictures of a camera", _measure_words),
    "fit": ("find the parameters with which a network reproduces a real picture", _fit_words),
    "photon-transfer": ("measure gain, read noise and full well from frames of flat fields",
                        _photon_transfer_words),
    "netd": ("measure SiTF, NETD and 3-D noise from frames of black bodies", _netd_words),
    "networks": ("list the example networks", lambda _parser: None),
    "modules": ("list the modules", _modules_words),
    "presets": ("list the built-in cameras, lenses, detectors and light", _presets_words),
    "bench": ("measure run time against error", _bench_words),
    "handbook": ("open the handbook at any page", _handbook_words),
}  # fmt: skip
"""What each command does in a few words, and what adds its words to a parser."""
