"""The words of the commands that measure a camera by frames of uniform fields, with their help."""

from __future__ import annotations

import argparse
from typing import Any

from app.options.command_words import Once
from app.options.option_values import TRANSFERS
from nodes.files.common.file_format import suffixes


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
