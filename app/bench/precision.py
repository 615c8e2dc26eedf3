"""Time in T0 against the largest error, for every choice that trades one for the other."""

from __future__ import annotations

from app.bench.precision_laws import MEASURES as LAWS
from app.bench.precision_pictures import MEASURES as PICTURES
from app.bench.precision_pupils import MEASURES as PUPILS
from app.bench.precision_wavelengths import MEASURES as WAVELENGTHS

MEASURES = (*PICTURES, *PUPILS, *WAVELENGTHS, *LAWS)
