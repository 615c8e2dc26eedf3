"""The words of each command, with their help."""

from __future__ import annotations

import argparse
from typing import Any

from app.options.option_values import OUTPUTS, REPORTS, STUDIES, SUMMARIES
from nodes.files.common.file_format import suffixes
from nodes.files.formats import SAVED

BENCH_PARTS = ("speed", "precision", "peers", "studies", "measure")
SCREENSHOT_PARTS = ("window", "canvas", "panel", "curves", "picture")


class Once(argparse.Action):
    """An option that may be given once."""

    # Kept on the namespace, not here: a parser may be used again.
    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: Any,
        option_string: str | None = None,
    ) -> None:
        """Keep the value, or refuse a second one."""
        given: set[str] = namespace.__dict__.setdefault("given", set())
        if self.dest in given:
            parser.error(f"{option_string} is given more than once")
        given.add(self.dest)
        setattr(namespace, self.dest, values)


def network_words(parser: argparse.ArgumentParser) -> None:
    """The network and its changes."""
    parser.add_argument("network", metavar="NETWORK", help="a file, or the name of a shipped one")
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NODE.PARAM=VALUE",
        help="change a parameter for this once; null empties it; may be repeated",
    )
    parser.add_argument(
        "--final",
        action=Once,
        metavar="NODE.PORT",
        help="the picture that is the network's output, in place of the one marked in the file",
    )
    _scene_words(parser)


def _scene_words(parser: argparse.ArgumentParser) -> None:
    """A picture in the place of the network's scene."""
    add: Any = parser.add_argument_group("a picture of your own").add_argument
    add(
        "--scene",
        action="append",
        default=[],
        metavar="[NODE=]FILE",
        help="a picture or cube in place of the network's scene; NODE says which of several",
    )
    add(
        "--scene-fov-deg",
        action=Once,
        nargs=2,
        metavar=("X", "Y"),
        help="its field of view (default: of its header, else as wide as the scene before)",
    )
    add("--scene-range-m", action=Once, metavar="M", help="its distance")
    add(
        "--scene-sample-m",
        action=Once,
        metavar="M",
        help="size of a sample on the scene, in place of the field of view",
    )
    add(
        "--scene-band-um",
        action=Once,
        nargs=2,
        metavar=("A", "B"),
        help="its band of wavelengths (default: of its header, else as of the scene before)",
    )
    add(
        "--scene-unit",
        action=Once,
        metavar="UNIT",
        help="what its samples are: a unit of radiance, K, C, reflectance, or relative: scaled to "
        "the range of the scene before (default: the file's unit, else relative)",
    )


def place_words(parser: argparse.ArgumentParser) -> None:
    """Where a run writes, and where its network may."""
    parser.add_argument(
        "--output-dir",
        action=Once,
        metavar="DIR",
        help="where final.png, mtf.csv and readouts.json go (default ./NAME-output)",
    )
    parser.add_argument(
        "--allow-writes-to",
        action="append",
        default=[],
        metavar="DIR",
        help="let nodes of the network write any file below DIR; without it, only in the network's "
        "folder and the output folder, and over no file that this network has not written; may be "
        "repeated",
    )


def edit_words(parser: argparse.ArgumentParser) -> None:
    """``imagechain edit``."""
    add: Any = parser.add_argument
    add("network", metavar="NETWORK", nargs="?", help="a file, or the name of a shipped one")
    add(
        "--screenshot",
        action=Once,
        metavar="FILE",
        help="draw the window, without a display, to a .png and end",
    )
    add(
        "--part",
        action=Once,
        choices=SCREENSHOT_PARTS,
        default="window",
        help="window (default), canvas, panel, curves, or the first viewer's picture within --size",
    )
    add(
        "--size",
        action=Once,
        metavar="WxH",
        help="of the window (default: as last time, at first by the screen; screenshot: 1600x900)",
    )
    add("--look", action=Once, choices=("dark", "light"), help="colours (default: as last time)")


def handbook_words(parser: argparse.ArgumentParser) -> None:
    """``imagechain handbook``."""
    add: Any = parser.add_argument
    add("word", metavar="WORD", nargs="?", help="a module, a page, or a word that a page has")
    add(
        "--html",
        action=Once,
        metavar="DIR",
        help="write the pages to a new folder, or over a handbook, and open nothing",
    )
    add("--path", action="store_true", help="print where the page is, and open nothing")


def run_words(parser: argparse.ArgumentParser) -> None:
    """``imagechain run``."""
    network_words(parser)
    add: Any = parser.add_argument
    add(
        "--save",
        action="append",
        default=[],
        metavar="NODE.PORT=FILE",
        help=f"write what a port gives, as {' '.join(suffixes(*SAVED))}; NODE.PORT[TOP:BOTTOM,"
        "LEFT:RIGHT]=FILE writes those rows and columns of an image, counted from 0, the ends "
        "exclusive, a bound left out being the image's; all bands of an image that has some go "
        "into a .bsq or .img (ENVI); a picture of any size as a .zarr store, too; may be repeated",
    )
    add(
        "--frames",
        action=Once,
        metavar="N",
        help="of each image saved N frames, each with temporal noise of its own; the first is the "
        "picture; as .npy (frames, rows, columns), .tif .tiff (a page each) or .bsq .img (ENVI, a "
        "band each)",
    )
    place_words(parser)
    add("--all", action="store_true", help="print the read-outs of all nodes, not the main figures")
    add(
        "--memory",
        action=Once,
        metavar="SIZE",
        help="what pictures may take, such as 2GB or 500MB (default: half of what the process may "
        "use); a network that would take more runs in blocks, its pictures on disk, with the same "
        "results",
    )
    add(
        "--scratch",
        action=Once,
        metavar="DIR",
        help="where pictures lie that memory is not to hold (default: beside the output)",
    )
    add(
        "--report",
        action="append",
        default=[],
        metavar="FILE",
        help=f"write a report, {' or '.join(suffixes(*REPORTS))}; may be repeated",
    )
    _numerical_words(parser)


def solve_words(parser: argparse.ArgumentParser) -> None:
    """``imagechain solve``."""
    network_words(parser)
    add: Any = parser.add_argument
    add(
        "--for",
        action=Once,
        required=True,
        dest="solve_for",
        metavar="NODE.PARAM[=LOW:HIGH]",
        help="the parameter that is sought, in its own range or the one given",
    )
    add(
        "--until",
        action=Once,
        required=True,
        metavar="NODE.READOUT=VALUE",
        help="the read-out, and the value that it is to have, in the read-out's unit",
    )
    _numerical_words(parser)


def fit_words(parser: argparse.ArgumentParser) -> None:
    """``imagechain fit``."""
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
    network_words(parser)
    add: Any = parser.add_argument
    add(
        "--to",
        nargs="+",
        required=True,
        metavar="PICTURE",
        help="one or more pictures of the camera; linear, as the sensor gives them, and not "
        "compressed with loss",
    )
    add(
        "--free",
        action="append",
        nargs="+",
        default=[],
        metavar="NODE.PARAM[=LOW:HIGH]",
        help="a parameter that is fitted, in its own range or the one given, such as "
        "jitter.sigma_mrad or optics.defocus_waves=0:2; may be repeated",
    )
    add(
        "--known-scene",
        action="store_true",
        help="the network's source is the scene of the picture: fit the whole picture to it",
    )
    add("--band", action=Once, metavar="N", help="band or colour to fit to, counted from 0")
    add("--json", action=Once, metavar="FILE", help="write parameters, errors and correlations")
    add("--output", action=Once, metavar="FILE", help="write the network with the fitted values")
    add(
        "--report",
        action=Once,
        metavar="FILE",
        help="write a page of the fit, .html: patches side by side, edges overlaid, residuals",
    )
    _numerical_words(parser)


def tradeoff_words(parser: argparse.ArgumentParser) -> None:
    """``imagechain tradeoff``."""
    network_words(parser)
    add: Any = parser.add_argument
    add(
        "--vary",
        action="append",
        default=[],
        required=True,
        metavar="NODE.PARAM=VALUES",
        help="what moves: FROM:TO:COUNT, FROM:TO:COUNT:log (equal factors), or values a,b,c; given "
        "twice, each value of the second makes a curve",
    )
    add(
        "--figure",
        action="append",
        default=[],
        metavar="NODE.READOUT",
        help="a figure of merit to show: a read-out of a node, or the chain's MTF as "
        "total.mtf_nyquist_x, total.mtf_half_nyquist_x (and _y) of the samples and, with pixel_ "
        "before nyquist, of the pixels; may be repeated (default: figures of the electronics and "
        "the chain's MTF, as far as they change)",
    )
    add(
        "--output",
        action="append",
        default=[],
        metavar="FILE",
        help=f"write the figures, as {' '.join(suffixes(*OUTPUTS))}; may be repeated",
    )
    _numerical_words(parser)


def study_words(parser: argparse.ArgumentParser) -> None:
    """``imagechain study``."""
    parser.description = (
        "Evaluate a network at every point of a grid, of a Latin hypercube or of a list, over "
        "every picture of a pattern, and write a row for each: its values, its figures, a key of "
        "what was computed, its seconds, and why it failed, if it did. A study that is stopped or "
        "killed goes on where it was when the same command is given again; what is done is kept in "
        "OUTPUT.journal until then."
    )
    network_words(parser)
    add: Any = parser.add_argument
    add(
        "--vary",
        action="append",
        default=[],
        metavar="NODE.PARAM=VALUES",
        help="what varies: FROM:TO:COUNT, FROM:TO:COUNT:log (equal factors), or values a,b,c; "
        "FROM:TO or FROM:TO:log where points are drawn; may be repeated",
    )
    add(
        "--over",
        action="append",
        default=[],
        metavar="NODE.PARAM=PATTERN",
        help="pictures that everything is computed for: files of a pattern, such as "
        "scene.path='scenes/*.img', 2 before 10; may be repeated",
    )
    add(
        "--sample",
        action=Once,
        default="grid",
        metavar="HOW",
        help="grid: every value with every other (default); latin: --points N drawn by a Latin "
        "hypercube of the network's seed; a .csv file: its rows, columns named NODE.PARAM",
    )
    add("--points", action=Once, metavar="N", help="how many points to draw")
    add(
        "--figure",
        action="append",
        default=[],
        metavar="NODE.READOUT",
        help="a figure of each point, as of tradeoff; may be repeated (default: figures of the "
        "electronics and the chain's MTF; none where pictures are saved)",
    )
    add(
        "--save",
        action="append",
        default=[],
        metavar="NODE.PORT=PATTERN",
        help="save each point's picture or curve, its name with fields in braces: {point}, "
        "{NODE.PARAM} of what varies, {scene} for the name of the picture; as "
        f"{' '.join(suffixes(*SAVED))}; may be repeated",
    )
    add(
        "--jobs",
        action=Once,
        metavar="N",
        help="processes on this machine (default: one, or all cores where the rest of the study "
        "takes so long that they are faster)",
    )
    add(
        "--memory",
        action=Once,
        metavar="SIZE",
        help="how much computed values may take, all processes together, such as 2GB (default: "
        "256MB in each process); for pictures of more than some 4000 x 4000 samples",
    )
    add(
        "--scheduler",
        action=Once,
        metavar="ADDRESS",
        help="a Dask scheduler, such as tls://10.0.0.1:8786, whose workers compute instead; they "
        "must have this program installed and see the same files",
    )
    for name, what in (
        ("--tls-ca-file", "certificate of the authority"),
        ("--tls-cert", "certificate"),
        ("--tls-key", "private key"),
    ):
        add(name, action=Once, metavar="FILE", help=f"{what} for a scheduler at tls://")
    add(
        "--output",
        action=Once,
        required=True,
        metavar="FILE",
        help=f"the rows, as {' '.join(suffixes(*STUDIES))}",
    )
    add(
        "--summary",
        action="append",
        default=[],
        metavar="FILE",
        help=f"a picture of the figures, as {' '.join(suffixes(*SUMMARIES))}; may be repeated",
    )
    add("--fresh", action="store_true", help="throw away what an unfinished study has left")
    _numerical_words(parser)


def _numerical_words(parser: argparse.ArgumentParser) -> None:
    add: Any = parser.add_argument
    add(
        "--precision",
        action=Once,
        choices=("single", "double"),
        default="single",
        help="default: single",
    )
    add(
        "--tolerance",
        action=Once,
        metavar="T",
        help="error budget: leave out stages that together change the picture by less than this "
        "fraction of its range, 0 to below 1 (default: below the precision's rounding, "
        "but 1e-4 of each band's contrast where few wavelengths stand for all bands; 0: only what "
        "changes nothing at all)",
    )
    add("--seed", action=Once, metavar="N", help="of the noise, in place of the network's")
    add("--threads", action=Once, metavar="N", help="worker threads (default: all)")


def bench_words(parser: argparse.ArgumentParser) -> None:
    """``imagechain bench``."""
    add: Any = parser.add_argument
    add("--json", metavar="FILE", help="write every figure, for programs")
    add("--html", metavar="FILE", help="write a page with tables and pictures")
    add("--quick", action="store_true", help="fewer repetitions and sizes")
    add(
        "--only",
        action="append",
        default=[],
        choices=BENCH_PARTS,
        metavar="PART",
        help="measure this part: " + ", ".join(BENCH_PARTS),
    )
    add("--size", metavar="N", help="samples along a side of the picture (default: 1024)")
