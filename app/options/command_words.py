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
        """Note the text, or refuse a second one."""
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
    _add(parser, "network", "NETWORK", "a file, or the name of a shipped one")
    _add(parser, "--set", "NODE.PARAM=VALUE",
         "change a parameter for this once; null empties it; may be repeated",
         partial(assignment, form="NODE.PARAM=VALUE"), many=True, dest="settings")  # fmt: skip
    _add(parser, "--final", "NODE.PORT",
         "the picture that is the network's output, in place of the one marked in the file",
    )  # fmt: skip
    add = partial(_add, parser.add_argument_group("a picture of your own"))
    add("--scene", "[NODE=]FILE",
        "a picture or cube in place of the network's scene; NODE says which of several",
        _scene, many=True, dest="scenes")  # fmt: skip
    add("--scene-fov-deg", ("X", "Y"),
        "its field of view (default: of its header, else as wide as the scene before)",
        finite_number, nargs=2)  # fmt: skip
    add("--scene-range-m", "M", "its distance", finite_number)
    add("--scene-sample-m", "M", "size of a sample on the scene, in place of the field of view",
        finite_number)  # fmt: skip
    add("--scene-band-um", ("A", "B"),
        "its band of wavelengths (default: of its header, else as of the scene before)",
        finite_number, nargs=2)  # fmt: skip
    add("--scene-unit", "UNIT",
        "what its samples are: a unit of radiance, K, C, reflectance, or relative: scaled to "
        "the range of the scene before (default: the file's unit, else relative)")  # fmt: skip


def _scene(option: str, text: str) -> str:
    file_path(option, text)
    return text


def _place_words(parser: Parser) -> None:
    _add(parser, "--output-dir", "DIR",
         "where final.png, mtf.csv and readouts.json go (default ./NAME-output)", file_path,
    )  # fmt: skip
    _add(parser, "--allow-writes-to", "DIR",
         "let nodes of the network write any file below DIR; without it, only in the network's "
         "folder and the output folder, and over no file that this network has not written; may "
         "be repeated", file_path, many=True, dest="allowed")  # fmt: skip


def _numerical_words(parser: Parser) -> None:
    parser.add_argument("--precision", action=Word, choices=("single", "double"),
                        help="default: single")  # fmt: skip
    _add(parser, "--tolerance", "T",
         "error budget: leave out stages that together change the picture by less than this "
         "fraction of its range, 0 to below 1 (default: below the precision's rounding, but 1e-4 "
         "of each band's contrast where few wavelengths stand for all bands; 0: only what changes "
         "nothing at all)", tolerance)  # fmt: skip
    _add(parser, "--seed", "N", "of the noise, in place of the network's",
         partial(whole_number, largest=LARGEST_INTEGER))  # fmt: skip
    _add(parser, "--threads", "N", "worker threads (default: all)",
         partial(whole_number, largest=1024))  # fmt: skip


def _edit_words(parser: Parser) -> None:
    add = partial(_add, parser)
    add("network", "NETWORK", "a file, or the name of a shipped one", nargs="?")
    add("--screenshot", "FILE", "draw the window, without a display, to a .png and end",
        ending_in(PNG))  # fmt: skip
    parser.add_argument("--part", action=Word, choices=SCREENSHOT_PARTS,
        help="window (default), canvas, panel, curves, or the first viewer's picture within --size",
    )  # fmt: skip
    add("--size", "WxH",
        "of the window (default: as last time, at first by the screen; screenshot: 1600x900)",
        window_size, dest="window_size")  # fmt: skip
    parser.add_argument("--look", action=Word, choices=("dark", "light"),
                        help="colours (default: as last time)")  # fmt: skip


def _run_words(parser: Parser) -> None:
    _network_words(parser)
    add = partial(_add, parser)
    add("--save", "NODE.PORT=FILE",
        f"write what a port gives, as {SAVED}; NODE.PORT[TOP:BOTTOM,"
        "LEFT:RIGHT]=FILE writes those rows and columns of an image, counted from 0, the ends "
        "exclusive, a bound left out being the image's; all bands of an image that has some go "
        "into a .bsq or .img (ENVI); a picture of any size as a .zarr store, too; may be repeated",
        _save, many=True, dest="saves")  # fmt: skip
    add("--frames", "N",
        "of each image saved N frames, each with temporal noise of its own; the first is the "
        "picture; as .npy (frames, rows, columns), .tif .tiff (a page each) or .bsq .img (ENVI, a "
        "band each)", whole_number)  # fmt: skip
    _place_words(parser)
    _flag(parser, "--all", "print the read-outs of all nodes, not the main figures")
    add("--memory", "SIZE",
        "what pictures may take, such as 2GB or 500MB (default: half of what the process may "
        "use); a network that would take more runs in blocks, its pictures on disk, with the same "
        "results", size_in_bytes, dest="memory_bytes")  # fmt: skip
    add("--scratch", "DIR",
        "where pictures lie that memory is not to hold (default: beside the output)", file_path,
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
        "what moves: FROM:TO:COUNT, FROM:TO:COUNT:log (equal factors), or values a,b,c; given "
        "twice, each value of the second makes a curve", many=True, required=True)  # fmt: skip
    add("--figure", "NODE.READOUT",
        "a figure of merit to show: a read-out of a node, or the chain's MTF as "
        "total.mtf_nyquist_x, total.mtf_half_nyquist_x (and _y) of the samples and, with pixel_ "
        "before nyquist, of the pixels; may be repeated (default: figures of the electronics and "
        "the chain's MTF, as far as they change)", many=True, dest="figures")  # fmt: skip
    add("--output", "FILE",
        f"write the figures, as {' '.join(suffixes(*OUTPUTS))}; may be repeated",
        ending_in(*OUTPUTS), many=True, dest="outputs")  # fmt: skip
    _numerical_words(parser)


def _study_words(parser: Parser) -> None:
    parser.description = (
        "Evaluate a network at every point of a grid, of a Latin hypercube or of a list, over "
        "every picture of a pattern, and write a row for each: its values, its figures, a key of "
        "what was computed, its seconds, and why it failed, if it did. A study that is stopped or "
        "killed goes on where it was when the same command is given again; what is done is kept in "
        "OUTPUT.journal until then."
    )
    _network_words(parser)
    add = partial(_add, parser)
    add("--vary", "NODE.PARAM=VALUES",
        "what varies: FROM:TO:COUNT, FROM:TO:COUNT:log (equal factors), or values a,b,c; "
        "FROM:TO or FROM:TO:log where points are drawn; may be repeated", many=True)  # fmt: skip
    add("--over", "NODE.PARAM=PATTERN",
        "pictures that everything is computed for: files of a pattern, such as "
        "scene.path='scenes/*.img', 2 before 10; may be repeated", many=True)  # fmt: skip
    add("--sample", "HOW",
        "grid: every value with every other (default); latin: --points N drawn by a Latin "
        "hypercube of the network's seed; a .csv file: its rows, columns named NODE.PARAM",
    )  # fmt: skip
    add("--points", "N", "how many points to draw", whole_number)
    add("--figure", "NODE.READOUT",
        "a figure of each point, as of tradeoff; may be repeated (default: figures of the "
        "electronics and the chain's MTF; none where pictures are saved)", many=True,
        dest="figures")  # fmt: skip
    add("--save", "NODE.PORT=PATTERN",
        "save each point's picture or curve, its name with fields in braces: {point}, "
        "{NODE.PARAM} of what varies, {scene} for the name of the picture; as "
        f"{SAVED}; may be repeated", _save, many=True, dest="saves",
    )  # fmt: skip
    add("--jobs", "N",
        "processes on this machine (default: one, or all cores where the rest of the study "
        "takes so long that they are faster)", whole_number)  # fmt: skip
    add("--memory", "SIZE",
        "how much computed values may take, all processes together, such as 2GB (default: "
        "256MB in each process); for pictures of more than some 4000 x 4000 samples",
        size_in_bytes, dest="memory_bytes")  # fmt: skip
    add("--scheduler", "ADDRESS",
        "a Dask scheduler, such as tls://10.0.0.1:8786, whose workers compute instead; they "
        "must have this program installed and see the same files")  # fmt: skip
    for name, what in (
        ("--tls-ca-file", "certificate of the authority"),
        ("--tls-cert", "certificate"),
        ("--tls-key", "private key"),
    ):
        add(name, "FILE", f"{what} for a scheduler at tls://")
    add("--output", "FILE", f"the rows, as {' '.join(suffixes(*STUDIES))}", study_path,
        required=True)  # fmt: skip
    add("--summary", "FILE",
        f"a picture of the figures, as {' '.join(suffixes(*SUMMARIES))}; may be repeated",
        summary_path, many=True, dest="summaries")  # fmt: skip
    _flag(parser, "--fresh", "throw away what an unfinished study has left")
    _numerical_words(parser)


def _solve_words(parser: Parser) -> None:
    _network_words(parser)
    add = partial(_add, parser, required=True)
    add("--for", "NODE.PARAM[=LOW:HIGH]",
        "the parameter that is sought, in its own range or the one given", dest="solve_for",
    )  # fmt: skip
    add("--until", "NODE.READOUT=VALUE",
        "the read-out, and the value that it is to have, in the read-out's unit")  # fmt: skip
    _numerical_words(parser)


def _measure_words(parser: Parser) -> None:
    parser.description = (
        "Measure pictures of a camera, real or simulated: edges that can be used are searched for "
        "in each, and the MTF measured across every one of them, with its standard error (ISO "
        "12233), and pooled across and along; of edges that are not used, why not. Noise is that "
        "of flat areas. Several pictures of one size, or files of frames, are taken as of one "
        "camera: their edges are pooled, and where they show the same scene, their noise is split "
        "by time, rows and columns."
    )
    parser.epilog = (
        "A picture of red, green and blue is measured by its luminance (0.2126 R + 0.7152 G + "
        "0.0722 B of the numbers as stored), one of other bands by --band. Of one compressed with "
        "loss, as JPEG, no figure is given. What could not be measured is absent, with the reason. "
        "Photograph a straight edge between a dark and a bright area, turned by about 5°, not "
        "clipped, and store its numbers as they are: imagechain handbook real_camera has how, and "
        "what the figures mean. "
        "Example: imagechain measure picture.tif --report measured.html --csv mtf.csv"
    )
    add = partial(_add, parser)
    add("pictures", "PICTURE",
        "a picture of any format that is read, or frames: .npy (frames, rows, columns), TIFF "
        "of a page each, ENVI of bands without wavelengths", file_path, nargs="+")  # fmt: skip
    _json(parser, "write everything that was measured, as .json")
    add("--csv", "FILE", "write the pooled MTF as a .csv table that the module MTF File reads",
        ending_in(CSV))  # fmt: skip
    add("--report", "FILE", "write a page, .html, with the edges drawn on the picture",
        ending_in(HTML))  # fmt: skip
    add("--band", "N", "band or colour to measure, counted from 0", whole_number)
    add("--fov-x-deg", "DEG",
        "field of view across, for frequencies in cycles/mrad (default: the header's)",
        finite_number)  # fmt: skip
    add("--pitch-um", "UM",
        "from one pixel to the next on the detector, for frequencies in cycles/mm", finite_number,
    )  # fmt: skip
    add("--flats", "FILE",
        "frames of flat fields, a file for each level, for the photon transfer curve (see "
        "imagechain photon-transfer --help)", file_path, nargs="+", many=True)  # fmt: skip
    add("--dark", "FILE", "frames without light, of the same exposure: for the read noise",
        file_path)  # fmt: skip
    add("--offset-dn", "DN", "the number of no light, where there are no dark frames (default: 0)",
        finite_number)  # fmt: skip


def _fit_words(parser: Parser) -> None:
    parser.description = (
        "Fit parameters of a network to pictures that a real camera has taken. Ideal edges take "
        "the place of the network's source where the pictures have edges; the chain's spread of "
        "them is compared with the samples, and every free parameter is given with its standard "
        "error. One sample of a picture is one of the network's final picture."
    )
    parser.epilog = (
        "Put pitch and focal length of the camera into the network first. Parameters with one "
        "effect on the edges get no number, but their combination; ranges make the search shorter. "
        "imagechain handbook real_camera leads through it. Example: imagechain fit mwir_camera "
        "--to picture.tif --free jitter.sigma_mrad=0:0.2 optics.defocus_waves=0:1 --report "
        "fit.html --output fitted.json"
    )
    _network_words(parser)
    add = partial(_add, parser)
    add("--to", "PICTURE",
        "one or more pictures of the camera; linear, as the sensor gives them, and not "
        "compressed with loss", file_path, nargs="+", required=True, dest="pictures")  # fmt: skip
    add("--free", "NODE.PARAM[=LOW:HIGH]",
        "a parameter that is fitted, in its own range or the one given, such as "
        "jitter.sigma_mrad or optics.defocus_waves=0:2; may be repeated", nargs="+", many=True,
    )  # fmt: skip
    _flag(parser, "--known-scene",
          "the network's source is the scene of the picture: fit the whole picture to it",
    )  # fmt: skip
    add("--band", "N", "band or colour to fit to, counted from 0", whole_number)
    _json(parser, "write parameters, errors and correlations")
    add("--output", "FILE", "write the network with the fitted values", ending_in(JSON))
    add("--report", "FILE",
        "write a page of the fit, .html: patches side by side, edges overlaid, residuals",
        ending_in(HTML))  # fmt: skip
    _numerical_words(parser)


def _photon_transfer_words(parser: Parser) -> None:
    parser.description = (
        "Measure a camera, real or simulated, by its photon transfer curve (Janesick 2007; EMVA "
        "1288): the temporal variance of pixels rises with their mean; the inverse of the slope is "
        "the gain, electrons of a digital number; its foot at the level of no electrons the read "
        "noise, less rounding; the level beyond which the variance collapses the full well; the "
        "variance among pixels DSNU and PRNU. What EMVA 1288 defines otherwise stands beside: K "
        "(DN of an electron), saturation capacity, sensitivity threshold, dynamic range, SNR max, "
        "DSNU and PRNU by rows, columns and pixels."
    )
    parser.epilog = (
        "Take five levels or more, from near the dark to beyond saturation, of a uniform field, "
        "with ten frames or more of each; lamps may flicker, pixels may not be clipped at 0. "
        "Levels up to 0.7 of saturation make the line. A field that is not uniform is warned of: "
        "its structure counts as PRNU and DSNU, gain and read noise stay right. Frames that are "
        "simulated need another --seed for each level. Example: imagechain photon-transfer "
        "flat1.tif flat2.tif flat3.tif --dark dark.tif --output camera.json"
    )
    add = partial(_add, parser)
    add("flats", "FILE",
        "frames of a flat field, two or more, a file for each level: .npy (frames, rows, "
        "columns), TIFF of a page each, ENVI of a band each", file_path, nargs="+")  # fmt: skip
    add("--dark", "FILE",
        "frames without light, two or more, of the same size and exposure: they give offset, "
        "read noise and DSNU", file_path)  # fmt: skip
    add("--offset-dn", "DN", "the number of no electrons, where there are no dark frames",
        finite_number)  # fmt: skip
    add("--output", "FILE",
        f"write the figures, and the levels, as {' '.join(suffixes(*TRANSFERS))}; may be "
        "repeated", ending_in(*TRANSFERS), many=True, dest="outputs")  # fmt: skip


def _netd_words(parser: Parser) -> None:
    parser.description = (
        "Measure an infrared camera, real or simulated, by frames of a black body that fills the "
        "field at two temperatures or more: SiTF, the numbers of a kelvin, and NETD, the noise "
        "over SiTF, with their standard errors; and the seven components of 3-D noise (D'Agostino "
        "and Webb 1991) in kelvin at each temperature."
    )
    parser.epilog = (
        "Take 64 frames or more of each temperature, and three temperatures or more some kelvin "
        "apart: two give the SiTF midway between them, three its change too. NETD is the noise "
        "that is random in time, row and column (sigma_tvh); what changes from frame to frame in "
        "whole rows, columns and frames stands beside, and in the sum of all of it. Bad pixels are "
        "left out, rounding is left in, and noise slower than the frames together counts as fixed. "
        "Example: imagechain netd cold.tif=20C middle.tif=25C "
        "hot.tif=30C --output netd.json"
    )
    add = partial(_add, parser)
    add("fields", "FILE=TEMPERATURE",
        "frames of a black body, two or more, and its temperature in K or °C, as 293.15K or "
        "20C; what emissivity and the air take is to be taken off it; formats as of "
        "photon-transfer", file_at_temperature, nargs="+")  # fmt: skip
    add("--output", "FILE",
        "write the figures, and those of each temperature, as "
        f"{' '.join(suffixes(*TRANSFERS))}; may be repeated", ending_in(*TRANSFERS), many=True,
        dest="outputs")  # fmt: skip


def _modules_words(parser: Parser) -> None:
    _add(parser, "key", "KEY|WORD",
         "only this module, or those in whose key, title or summary this word stands", nargs="?",
    )  # fmt: skip


def _handbook_words(parser: Parser) -> None:
    _add(parser, "word", "WORD", "a module, a page, or a word that a page has", nargs="?")
    _add(parser, "--html", "DIR",
         "write the pages to a new folder, or over a handbook, and open nothing", file_path,
    )  # fmt: skip
    _flag(parser, "--path", "print where the page is, and open nothing")


def _bench_words(parser: Parser) -> None:
    _json(parser, "write every figure, for programs", file_path)
    _add(parser, "--html", "FILE", "write a page with tables and pictures", file_path)
    _flag(parser, "--quick", "fewer repetitions and sizes")
    _add(parser, "--only", "PART", "measure this part: " + ", ".join(BENCH_PARTS), many=True,
         choices=BENCH_PARTS)  # fmt: skip
    _add(parser, "--size", "N", "samples along a side of the picture (default: 1024)",
         whole_number)  # fmt: skip


def _json(parser: Parser, about: str, read: Read | None = None) -> None:
    """``--json`` of a command that writes JSON to a file, too."""
    _add(parser, "--json", "FILE", f"{about}; without FILE print it, and nothing else",
         read or ending_in(JSON), nargs="?")  # fmt: skip


def _no_words(_parser: Parser) -> None:
    pass


COMMANDS: dict[str, tuple[str, Callable[[Parser], None]]] = {
    "edit": ("open the editor", _edit_words),
    "run": ("evaluate a network", _run_words),
    "check": ("validate a network", _check_words),
    "tradeoff": ("figures of merit as a parameter moves", _tradeoff_words),
    "study": ("figures and pictures at many points, over many scenes", _study_words),
    "solve": ("the value of a parameter at which a read-out is as wanted", _solve_words),
    "measure": ("edges, MTF and noise of pictures of a camera", _measure_words),
    "fit": ("the parameters with which a network gives a real picture's edges", _fit_words),
    "photon-transfer": ("gain, read noise and full well from frames of flat fields",
                        _photon_transfer_words),
    "netd": ("SiTF, NETD and 3-D noise from frames of black bodies", _netd_words),
    "networks": ("list the shipped networks", _no_words),
    "modules": ("list the library", _modules_words),
    "bench": ("time against error", _bench_words),
    "handbook": ("open the handbook, at any page", _handbook_words),
}  # fmt: skip
"""What each command does in a few words, and what adds its words to a parser."""
