"""Measures of the part `scale`: studies, and scenes beyond memory."""

from __future__ import annotations

from app.bench.scale.scale_blocks import MEASURES as BLOCKS
from app.bench.scale.study_scale import studies

MEASURES = (studies, *BLOCKS)
