"""Modules whose effect is about as large as an error budget."""

from __future__ import annotations

from math import sqrt
from random import Random
from typing import Any

from drawn_modules import Item, Modules, Params, Sampling, short


class FaintModules(Modules):
    """Largest |1 − H| of a fiftieth to twenty times the budget, each stage by itself."""

    def __init__(self, random: Random, frames: Any, budget: float) -> None:
        super().__init__(random, frames)
        self.budget = budget

    def size(self) -> float:
        return self.budget * self.log(-1.7, 1.3)

    def width(self, interval: float) -> float:
        """1 − H goes with the square of a blur's width."""
        return 0.0 if self.random.random() < 0.1 else short(interval * sqrt(self.size()))

    def detector_mtf(self, at: Sampling) -> Params:
        return {
            "detector_x_um": short(100 * at.interval_x * sqrt(self.size())),
            "detector_y_um": short(100 * at.interval_y * sqrt(self.size())),
            "focal_length_mm": 100.0,
        }

    def charge_eff_mtf(self, at: Sampling) -> Params:
        return {
            **super().charge_eff_mtf(at),
            "detectors_per_line": 1,
            "efficiency": max(1 - self.size(), 0.0),
        }

    charge_eff_phase = charge_eff_mtf

    def atmosphere_mtf(self, at: Sampling) -> Params:
        params = super().atmosphere_mtf(at)
        if params["turbulence"].endswith("exposure"):
            params.pop("cn2", None)
            lag_mm = params["wavelength_um"] * 0.5 / at.interval_x
            params["fried_r0_m"] = short(lag_mm / 1000 * self.size() ** -0.6)
        params |= {"turbidity": "custom", "scatter_depth": short(self.size())}
        return params

    def exit_pupil_mtf(self, at: Sampling) -> Item:
        """1 − H goes with frequency over cutoff."""
        made = super().exit_pupil_mtf(at)
        for axis in "xy":
            made.params[f"size_{axis}_cm"] *= 1 / self.size()
        return made
