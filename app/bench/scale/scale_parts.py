"""The tables on scale."""

from __future__ import annotations

from app.bench.scale.study_scale import studies

MEASURES = (studies,)
