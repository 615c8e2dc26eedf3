"""Time in T0 against the largest error, for every choice that trades one for the other."""

from __future__ import annotations

from app.bench.precision.precision_bands import MEASURES as BANDS
from app.bench.precision.precision_charge_transfer import MEASURES as CHARGE_TRANSFER
from app.bench.precision.precision_low_rank import MEASURES as LOW_RANK
from app.bench.precision.precision_pictures import MEASURES as PICTURES
from app.bench.precision.precision_poisson import MEASURES as POISSON
from app.bench.precision.precision_pupils import MEASURES as PUPILS
from app.bench.precision.precision_quantile import MEASURES as QUANTILES
from app.bench.precision.precision_scanning import MEASURES as SCANNING
from app.bench.precision.precision_skip import MEASURES as SKIPPING
from app.bench.precision.precision_spatial import MEASURES as SPATIAL
from app.bench.precision.precision_wavelengths import MEASURES as WAVELENGTHS

MEASURES = (
    *PICTURES,
    *PUPILS,
    *LOW_RANK,
    *WAVELENGTHS,
    *BANDS,
    *CHARGE_TRANSFER,
    *POISSON,
    *QUANTILES,
    *SKIPPING,
    *SCANNING,
    *SPATIAL,
)
