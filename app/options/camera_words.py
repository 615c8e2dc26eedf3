"""The words of the commands that measure a camera by its pictures, with their help."""

from __future__ import annotations

import argparse
from typing import Any

from app.options.command_words import Once
from app.options.option_values import TRANSFERS
from nodes.files.common.file_format import suffixes


def measure_words(parser: argparse.ArgumentParser) -> None:
    """``imagechain measure``."""
    add: Any = parser.add_argument
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
    add(
        "pictures",
        metavar="PICTURE",
        nargs="+",
        help="a picture of any format that is read, or frames: .npy (frames, rows, columns), TIFF "
        "of a page each, ENVI of bands without wavelengths",
    )
    add("--json", action=Once, metavar="FILE", help="write everything that was measured, as .json")
    add(
        "--csv",
        action=Once,
        metavar="FILE",
        help="write the pooled MTF as a .csv table that the module MTF File reads",
    )
    add(
        "--report",
        action=Once,
        metavar="FILE",
        help="write a page, .html, with the edges drawn on the picture",
    )
    add("--band", action=Once, metavar="N", help="band or colour to measure, counted from 0")
    add(
        "--fov-x-deg",
        action=Once,
        metavar="DEG",
        help="field of view across, for frequencies in cycles/mrad (default: the header's)",
    )
    add(
        "--pitch-um",
        action=Once,
        metavar="UM",
        help="from one pixel to the next on the detector, for frequencies in cycles/mm",
    )
    add(
        "--flats",
        action="extend",
        nargs="+",
        default=[],
        metavar="FILE",
        help="frames of flat fields, a file for each level, for the photon transfer curve (see "
        "imagechain photon-transfer --help)",
    )
    add(
        "--dark",
        action=Once,
        metavar="FILE",
        help="frames without light, of the same exposure: for the read noise",
    )
    add(
        "--offset-dn",
        action=Once,
        metavar="DN",
        help="the number of no light, where there are no dark frames (default: 0)",
    )


def photon_transfer_words(parser: argparse.ArgumentParser) -> None:
    """``imagechain photon-transfer``."""
    add: Any = parser.add_argument
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
    add(
        "flats",
        metavar="FILE",
        nargs="+",
        help="frames of a flat field, two or more, a file for each level: .npy (frames, rows, "
        "columns), TIFF of a page each, ENVI of a band each",
    )
    add(
        "--dark",
        action=Once,
        metavar="FILE",
        help="frames without light, two or more, of the same size and exposure: they give offset, "
        "read noise and DSNU",
    )
    add(
        "--offset-dn",
        action=Once,
        metavar="DN",
        help="the number of no electrons, where there are no dark frames",
    )
    add(
        "--output",
        action="append",
        default=[],
        metavar="FILE",
        help=f"write the figures, and the levels, as {' '.join(suffixes(*TRANSFERS))}; may be "
        "repeated",
    )


def netd_words(parser: argparse.ArgumentParser) -> None:
    """``imagechain netd``."""
    add: Any = parser.add_argument
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
    add(
        "fields",
        metavar="FILE=TEMPERATURE",
        nargs="+",
        help="frames of a black body, two or more, and its temperature in K or °C, as 293.15K or "
        "20C; what emissivity and the air take is to be taken off it; formats as of "
        "photon-transfer",
    )
    add(
        "--output",
        action="append",
        default=[],
        metavar="FILE",
        help="write the figures, and those of each temperature, as "
        f"{' '.join(suffixes(*TRANSFERS))}; may be repeated",
    )
