"""The choice of the number of wavelengths that stand for a band."""

from __future__ import annotations

import numpy as np

from app.bench.measuring.bench_settings import Settings
from app.bench.measuring.bench_tables import Chart, Table
from app.bench.measuring.kodak import Kodak
from app.bench.measuring.timing import paired, round_trip
from app.bench.truth import truth_laws as truth
from app.bench.truth.network_pupils import ARRAY_MM, PART, RADIUS_MM, WAVELENGTH_UM, Otf


def wavelengths(settings: Settings) -> list[Table]:
    """Number of wavelengths that stand for a band, for two apertures."""
    mp = truth.mpmath()
    title = f"Wavelengths for the band 3 to 5 µm, {settings.small}² frequencies"
    heads = {
        "aperture": "aperture",
        "choice": "wavelengths",
        "t0": "T0",
        "ms": "ms",
        "error": "largest error",
    }
    if mp is None:
        return [Table("wavelengths", title, heads, (), truth.NEEDS_MPMATH)]
    kodak = Kodak(settings.small)
    t0 = round_trip(kodak.scene, kodak.policy.workers)
    counts = (1, 3, 9, 33) if settings.quick else (1, 2, 3, 5, 9, 17, 33, 129)
    nyquist = kodak.engine.plan(kodak.network).output("init.context").grid.nyquist_x
    xi = np.linspace(0.0, nyquist, 17)
    # A radius in samples whose cutoff at the band's middle is half the Nyquist frequency.
    small = max(0.5 * nyquist * WAVELENGTH_UM / (2 * ARRAY_MM * PART), 0.5)
    radii = {"Kodak's": RADIUS_MM / ARRAY_MM / PART, "small, cutoff in the band": small}
    rows = []
    for aperture, radius in radii.items():
        diameter_mm = 2 * radius * ARRAY_MM * PART
        expected = [truth.disc_band_mean(mp, float(f), diameter_mm, (3, 5)) for f in xi]
        for count in counts:
            network = kodak.network.with_parameter("pupil", "radius", radius)
            otf = Otf(kodak, network.with_parameter("optics", "wavelengths", count))
            computed = otf.factor.transfer(kodak.work, xi, np.zeros_like(xi))
            rows.append(
                {
                    "aperture": aperture,
                    "choice": count,
                    **paired(otf.plane, t0, pairs=3, warm_up=1).facts(),
                    "error": float(np.abs(computed - np.array(expected)).max()),
                }
            )
    text = (
        "Default 1, the band's mean wavelength: over the picture's frequencies the OTF of an "
        "aperture such as Kodak's is almost a straight line in λ. Take more where the cutoff falls "
        "among them, as for the small one; the truth is an adaptive integral over the band."
    )
    chart = Chart("t0", "error", "time (T0)", "largest error", "choice", "aperture", lines=True)
    return [Table("wavelengths", title, heads, tuple(rows), text, chart)]


MEASURES = (wavelengths,)
