"""Small files of a lens, for the examples with which every module is tried."""

from pathlib import Path


def write_lens_files(folder: Path) -> None:
    """Tables of MTF, of both axes with their phases and round, and an uneven PSF."""
    (folder / "mtf.csv").write_text(
        "frequency (cyc/mm),mtf_x,mtf_y,phase_x,phase_y (deg)\n"
        "0,1,1,0,0\n10,0.9,0.8,-0.1,3\n30,0.6,0.5,-0.5,20\n90,0,0.1,-2,90\n",
        encoding="utf-8",
    )
    (folder / "round.csv").write_text("frequency_cyc_per_mrad;mtf\n0.3;0.9\n2;0.3\n5;0\n")
    (folder / "psf.txt").write_text("1 2 1 1\n2 9 5 3\n1 3 2 1\n", encoding="utf-8")
