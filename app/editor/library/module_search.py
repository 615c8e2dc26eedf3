"""Search of modules by typed words."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from core.modules.declaration import Declaration
from nodes.files.formats import readable_formats

# Common names that are not in its title or summary.
_ALSO: Mapping[str, str] = MappingProxyType(
    {
        "test_scene": "target bars edge star chart",
        "read_image": f"load import DIRSIG {readable_formats()}",
        "mtf_file": "measured lens curve CSV Zemax data sheet bring import",
        "psf_file": "point spread function measured lens star Zemax bring import kernel",
        "poisson_noise": "photon shot noise",
        "periodic_noise": "banding striping coherent",
        "line_of_sight": "LOS PSD power spectral density stabilization pointing drift",
        "tdi_mtf": "time delay integration clock smear",
        "focal_plane": "FPA camera electrons QE well ADC NETD NEI PRNU DSNU dark current TDI",
        "noise_3d_source": "1/f flicker NVESD",
        "microbolometer": "uncooled LWIR thermal detector VOx",
        "nuc": "FPN shutter flat field calibration gain offset",
        "electronics_noise": "banding striping fixed pattern FPN NUC ADC",
        "mtf_slices": "OTF plot",
        "measured_mtf": "ROI region of interest knife edge ESF LSF SFR ISO 12233",
        "image_quality": "NIIRS RER interpretability",
        "figures_of_merit": "Johnson TTP FLIR92 NVTherm target",
        "noise_budget": "share contribution breakdown",
        "noise_3d": "3D fixed pattern FPN banding striping",
        "compare_images": "difference RMSE PSNR",
        "spatial_blur": "PSF kernel",
        "camera_geometry": "roll pitch yaw panoramic GSD resample",
        "line_by_line": "panoramic mixed",
    }
)


def found_by(declared: Declaration) -> tuple[str, str, str]:
    """Texts in which a typed word is looked for, those that count most first."""
    readouts = " ".join(readout.name.replace("_", " ") for readout in declared.readouts)
    texts = (
        f"{declared.title}\n{declared.key}\n{declared.group}",
        declared.summary,
        f"{_ALSO.get(declared.key, '')} {readouts}",
    )
    names, summary, further = (text.casefold() for text in texts)
    return names, summary, further


def rank(texts: tuple[str, str, str], typed: str) -> int | None:
    """How well typed words fit, 1 the best; 0 where none is typed, None where one does not occur.

    1 where they are the whole title or key, in any order; then in how many texts all are found.
    """
    words = typed.casefold().split()
    if not words:
        return 0
    names = (line.replace("_", " ").split() for line in texts[0].splitlines()[:2])
    if any(sorted(words) == sorted(name) for name in names):
        return 1
    for count in range(1, len(texts) + 1):
        known = " ".join(texts[:count])
        if all(word in known for word in words):
            return count + 1
    return None
