"""Measuring pictures, and fitting networks to them."""

from app.bench.speed.fit_speed import fitting
from app.bench.speed.measure_speed import measuring

MEASURES = (measuring, fitting)
