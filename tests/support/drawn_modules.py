"""Modules with parameters drawn about what matters to a picture of a given sampling."""

from dataclasses import dataclass, field, replace
from math import log10
from random import Random
from typing import Any

Params = dict[str, Any]


@dataclass(frozen=True)
class Sampling:
    """A picture as it comes to a module."""

    rows: int
    columns: int
    interval_x: float
    interval_y: float


@dataclass(frozen=True)
class Item:
    """A module to be put in a chain; a pupil's own node goes before it."""

    key: str
    params: Params
    pupil: Params = field(default_factory=dict)
    disabled: bool = False


def short(number: float) -> float:
    """A number a person would type, so that a network that fails can be read."""
    return float(f"{number:.4g}")


class Modules:
    """Draws parameters; lengths are of the order of the sampling, from nothing to enormous."""

    def __init__(self, random: Random, folder_frames: dict[tuple[int, int], list[str]]) -> None:
        self.random, self.frames = random, folder_frames

    def log(self, low: float, high: float) -> float:
        return short(10 ** self.random.uniform(low, high))

    def signed(self, low: float, high: float) -> float:
        return self.random.choice((-1, 1)) * self.log(low, high)

    def width(self, interval: float) -> float:
        """Nothing, some hundredths to ten samples, or far more than the frame."""
        chance = self.random.random()
        if chance < 0.15:
            return 0.0
        return short(interval * (self.log(2, 6) if chance < 0.2 else self.log(-2, 1)))

    def maybe(self, params: Params, name: str, value: Any, chance: float = 0.5) -> None:
        if self.random.random() < chance:
            params[name] = value

    def item(self, key: str, at: Sampling) -> Item:
        made = getattr(self, key)(at)
        return replace(
            made if isinstance(made, Item) else Item(key, made),
            disabled=self.random.random() < 0.03,
        )

    # ------------------------------------------------------------ on the spectrum

    def gaussian_mtf(self, at: Sampling) -> Params:
        return {
            "sigma_x_mrad": self.width(at.interval_x), "sigma_y_mrad": self.width(at.interval_y),
        }  # fmt: skip

    def jitter_mtf(self, at: Sampling) -> Params:
        return {"sigma_mrad": self.width(at.interval_x)}

    def detector_mtf(self, at: Sampling) -> Params:
        params: Params = {}
        self.maybe(params, "focal_length_mm", short(1000 / at.interval_x))
        self.maybe(params, "detector_x_um", self.log(1.5, 3.5))
        self.maybe(params, "detector_y_um", self.log(1.5, 3.5))
        self.maybe(params, "fill_x", self.log(-1, 0))
        self.maybe(params, "fill_y", self.random.choice((1.0, 0.8)))
        return params

    def crosstrack_mtf(self, at: Sampling) -> Params:
        params: Params = {"dwell_time_s": short(self.width(at.interval_x) / 100)}
        self.maybe(params, "scan_velocity_mrad_per_s", self.log(0, 3))
        return params

    def alongtrack_mtf(self, at: Sampling) -> Params:
        params: Params = {"integration_time_s": short(self.width(at.interval_y) / 100)}
        self.maybe(params, "velocity_m_per_s", self.signed(0, 3))
        self.maybe(params, "range_m", self.log(2, 4))
        return params

    def relative_motion_mtf(self, at: Sampling) -> Params:
        params: Params = {
            "integration_time_s": short(self.width(at.interval_y) / 100),
            "model": self.random.choice(("published", "line")),
        }
        for name in ("image_velocity_x", "image_velocity_y", "platform_velocity_x",
                     "platform_velocity_y"):  # fmt: skip
            self.maybe(params, name, self.signed(0, 2.5))
        self.maybe(params, "range_m", self.log(2, 4))
        return params

    def vibration_mtf(self, at: Sampling) -> Params:
        params: Params = {
            f"amplitude_{axis}_mrad": min(self.width(interval), 60 * interval)
            for axis, interval in (("x", at.interval_x), ("y", at.interval_y))
        }
        if self.random.random() < 0.6:
            rate = self.random.randint(1, 40)
            # Whole periods, clearly not whole ones, or less than one.
            time = self.random.choice((2.0, 0.25 * 4, self.log(-3, 1)))
            params |= {"frequency_Hz": float(rate), "integration_time_s": time}
            if abs(rate * time - round(rate * time)) < 1e-6 and time not in (1.0, 2.0):
                params["integration_time_s"] = time + 1 / (3 * rate)
        return params

    def charge_eff_mtf(self, _: Sampling) -> Params:
        lost = self.random.choice((0.5, 1e-5, self.log(-6, -0.1)))
        params: Params = {
            "detectors_per_line": self.random.choice((0, 1, 3, 640, 100_000)),
            "efficiency": self.random.choice((1.0, float(f"{1 - lost:.6f}"))),
            "model": self.random.choice(("exact", "published", "leading")),
            "nyquist": self.random.choice(("image", "detector")),
        }
        if (1 - params["efficiency"]) * params["detectors_per_line"] > 1000:
            params["detectors_per_line"] = self.random.randint(1, 700)
        return params

    charge_eff_phase = charge_eff_mtf

    def atmosphere_mtf(self, at: Sampling) -> Params:
        choice = self.random.choice
        nyquist = 0.5 / at.interval_x
        kind = choice(("gaussian", "long_exposure", "short_exposure", "none"))
        params: Params = {"turbulence": kind, "fwhm_mrad": self.width(at.interval_x)}
        if kind.endswith("exposure"):
            params["wavelength_um"] = self.log(-0.3, 1.1)
            lag_mm = params["wavelength_um"] * nyquist
            params["aperture_mm"] = short(lag_mm * self.log(-0.5, 1.5))
            params["alpha"] = choice((0.0, 0.5, 1.0, 0.3))
            params["view"] = choice(("horizontal", "vertical", "up"))
            if self.random.random() < 0.3:
                params["cn2"] = self.log(-16, -12)
            else:
                params["fried_r0_m"] = short(lag_mm / 1000 * self.log(-1, 2))
        level = choice(("none", "none", "low", "moderate", "high", "custom"))
        params["turbidity"] = level
        params["turbidity_cutoff_cyc_per_mrad"] = short(nyquist * self.log(-3, 1))
        if level == "custom":
            params["view"] = choice(("horizontal", "vertical", "up"))
            if self.random.random() < 0.5:
                params["scatter_depth"] = self.log(-3, 1)
            else:
                params |= {
                    "absorption_per_km": self.log(-3, 0),
                    "scattering_per_km": self.log(-2, 1),
                }
                self.maybe(params, "scale_height_km", self.log(-0.7, 1))
        return params

    def exit_pupil_mtf(self, at: Sampling) -> Item:
        pupil = self.pupil(at)
        on = self.log(-0.3, 1)
        off = short(on * self.random.uniform(1, 1.5))
        params: Params = {
            "cut_on_um": on, "cut_off_um": off, "wavelengths": self.random.choice((1, 1, 1, 2, 3)),
        }  # fmt: skip
        # The cutoff from below the first frequency to far beyond Nyquist.
        wide = self.log(-1.5, 1.3) * (on + off) / 2
        pitch_mm = wide * 0.5 / at.interval_x / (2 * pupil.get("radius", 5.0))
        other = pitch_mm * self.random.choice((1, 1, 1.3, 0.6))
        params["size_x_cm"] = short(pitch_mm * pupil["size_x"] / 10)
        params["size_y_cm"] = short(other * pupil["size_y"] / 10)
        self.maybe(params, "method", "autocorrelation", 0.15)
        self.maybe(params, "interpolation", self.random.choice(("none", "linear")), 0.3)
        return Item("exit_pupil_mtf", params, pupil)

    def pupil(self, at: Sampling) -> Params:
        # The slow reference takes its time for straight outlines.
        few, many = at.rows * at.columns <= 40, at.rows * at.columns > 1000
        shape = self.random.choices(
            ("clear", "cassegrain", "file", "half_moon", "hinged", "cassegrain_slit", "spider"),
            (8, 8, 2, 0, 0, 0, 0) if many else (8, 8, 2, 3, 3, 3, 1),
        )[0]
        if shape == "file":
            path = self.random.choice(self.frames["pupil", 0])
            pupil: Params = {"shape": shape, "path": path, "radius": 4.5, "size_x": 9, "size_y": 8}
        else:
            size = self.random.randint(8, 11)
            radius = short(self.random.uniform(2.5, size / 2))
            pupil = {
                "shape": shape, "radius": radius, "size_x": size,
                "size_y": size + self.random.choice((0, 0, 1, 3)),
                "obscuration_radius": short(radius * self.random.choice((0, 0.2, 0.5, 0.7))),
                "slit_width": short(radius * self.random.choice((0, 0.1, 0.7, 1))),
                "vanes": self.random.randint(0, 4),
                "vane_width": short(radius * self.random.choice((0, 0.1, 0.4))),
            }  # fmt: skip
        if shape == "spider" and not few:
            pupil["vanes"] = min(pupil["vanes"], 1)
        if self.random.random() < 0.15 and not (many and shape == "clear"):
            pupil["defocus_waves"] = self.signed(-1.5, 0.3)
        if self.random.random() < 0.06:
            pupil["zernike_waves"] = [
                self.signed(-2.5, -0.7) for _ in range(self.random.randint(1, 11))
            ]
        return pupil

    # ------------------------------------------------------------ on the picture

    def combine_pixels(self, at: Sampling) -> Params:
        return {
            "factor_x": self.random.randint(1, min(at.columns, 5)),
            "factor_y": self.random.randint(1, min(at.rows, 4)),
            "mode": self.random.choice(("mean", "mean", "sum")),
        }

    def sample_pixels(self, at: Sampling) -> Params:
        params: Params = {}
        for axis, size in (("x", at.columns), ("y", at.rows)):
            ratio = self.random.choice((1.0, 2.0, 3.0, 4.0, self.log(-0.3, 0.7)))
            params[f"factor_{axis}"] = min(ratio, float(size))
        self.maybe(params, "offset", short(self.random.uniform(-1, 1)), 0.3)
        self.maybe(params, "offset_y", short(self.random.uniform(-1, 1)), 0.2)
        return params

    def focal_plane(self, at: Sampling) -> Params:
        choice, on = self.random.choice, self.log(-0.3, 1)
        params: Params = {
            "cut_on_um": on, "cut_off_um": short(on * self.random.uniform(1.05, 1.6)),
            # Temperatures of many samples take the slow reference its time.
            "photon_weighting": choice(
                ("middle", "source", "scene") if at.rows * at.columns <= 300 else
                ("middle", "source")
            ),
            "source_K": choice((1000.0, 2856.0, 5800.0)), "integration_time_s": self.log(-6, 0),
            "tdi_stages": choice((1, 1, 8, 64)), "frames_averaged": choice((1, 1, 4)),
            "quantum_efficiency": self.log(-1, 0), "optics_transmission": self.log(-1, 0),
            "units": choice(("dn", "electrons", "radiance")), "full_well_e": self.log(4, 12),
            "read_noise_e": choice((0.0, 30.0)), "prnu_percent": choice((0.0, 1.0)),
            "dsnu_e": choice((0.0, 20.0)), "bad_pixel_percent": choice((0.0, 0.0, 3.0)),
            "bits": choice((0, 8, 14, 16)), "offset_dn": choice((0.0, 64.0)),
        }  # fmt: skip
        self.maybe(params, "optics_K", short(self.random.uniform(200, 330)), 0.3)
        self.maybe(params, "dark_current_e_per_s", self.log(2, 9), 0.3)
        self.maybe(params, "gain_e_per_dn", self.log(-1, 3), 0.3)
        if self.random.random() < 0.3:
            params["cold_shield_efficiency"] = short(self.random.uniform(0, 1))
            params["housing_K"] = short(self.random.uniform(200, 330))
        if params["units"] != "radiance":
            self.maybe(params, "nonlinearity_percent", choice((0.5, 3.0, 25.0)), 0.3)
        return params

    def microbolometer(self, at: Sampling) -> Params:
        return {
            "cut_on_um": 8.0,
            "cut_off_um": 14.0,
            "netd_mK": self.log(0, 3),
            "time_constant_s": min(short(self.width(at.interval_x) / 100), 1000.0),
            "response_percent": self.random.choice((0.0, 2.0)),
            "offset_mK": self.random.choice((0.0, 500.0)),
            "corner_Hz": self.random.choice((0.0, 0.0, 1.0)),
        }

    def nuc(self, _: Sampling) -> Params:
        choice = self.random.choice
        return {
            "method": choice(("none", "one_point", "two_point")),
            "reference_frames": choice((1, 3)), "drift_K": choice((0.0, 0.1)),
        }  # fmt: skip

    def noise_3d_source(self, _: Sampling) -> Params:
        names = ("tvh", "tv", "th", "t", "vh", "v", "h")
        return {f"sigma_{name}": self.random.choice((0.0, self.log(-2, 1))) for name in names}

    def interpolate(self, at: Sampling) -> Params:
        params: Params = {"order": self.random.choice((0, 1, 3))}
        for name, old in (("width", at.columns), ("height", at.rows)):
            low, high = (1, 17) if old <= 17 else (old // 2, old + 9)
            self.maybe(params, name, self.random.randint(low, high), 0.8)
        return params

    def anti_alias(self, _: Sampling) -> Params:
        return {
            "kernel": self.random.choice(("box", "gaussian", "lanczos")),
            "factor": self.random.choice((1, 2, 2, 3, 4, 7)),
        }

    def periodic_noise(self, at: Sampling) -> Params:
        # Cycles over the frame are bounded: the last one's phase has the rounding of all of them.
        fastest = min(0.5, 2 - log10(max(at.rows, at.columns)))
        params: Params = {
            "amplitude": self.random.choice((0.0, self.signed(-1, 2))),
            "xi": self.signed(-2, fastest) / at.interval_x,
            "eta": self.signed(-2, fastest) / at.interval_y,
            "phase_deg": short(self.random.uniform(-400, 400)),
        }  # fmt: skip
        if self.random.random() < 0.5:
            params |= {
                "modulation": short(self.random.random()),
                "modulation_xi": self.signed(-2, fastest) / at.interval_x,
                "modulation_eta": self.signed(-2, fastest) / at.interval_y,
                "modulation_phase_deg": short(self.random.uniform(-400, 400)),
            }
        return params

    def noise_file(self, at: Sampling) -> Item:
        fitting = self.frames.get((at.rows, at.columns))
        if not fitting:
            return Item("interpolate", self.interpolate(at))
        scale = self.random.choice((0.0, 1.0, self.signed(-2, 0)))
        return Item("noise_file", {"path": self.random.choice(fitting), "scale": scale})

    def electronics_noise(self, at: Sampling) -> Params:
        # With such a detector the noise is below every rounding; no gain errors are drawn.
        params: Params = {
            "d_star": 1e40, "background_K": 300.0, "bandwidth_Hz": 1e4, "cut_on_um": 8.0,
            "cut_off_um": 12.0,
        }  # fmt: skip
        if self.random.random() < 0.2:
            params |= {
                "gain_model": "literal", "gain_percent": self.log(-1, 1),
                "bias_percent": self.random.choice((0.0, self.log(-1, 1))),
            }  # fmt: skip
        rate = self.log(-2, 1)
        self.maybe(params, "scan_mirror_rate_Hz", rate)
        velocity = 6283 * rate if "scan_mirror_rate_Hz" in params else 100.0
        if self.random.random() < 0.4:
            params["use_mtf"] = True
            self.maybe(params, "time_constant_s", short(self.width(at.interval_x) / velocity))
        if self.random.random() < 0.4:
            params["post_filter"] = self.random.choice(("lowpass", "highpass", "boost"))
            params["post_corner_Hz"] = short(velocity / at.interval_x * self.log(-2, 0.5))
            params["post_poles"] = self.random.choice((1, 2, 5))
            params["post_gain"] = self.random.choice((1.0, 2.0, 7.5))
        if self.random.random() < 0.5:
            params["bits"] = self.random.choice((4, 6, 8, 8, 8, 12, 16, 24, 32, 64))
            if self.random.random() < 0.3:
                params |= {"range_low": self.log(0, 1), "range_high": self.log(1.2, 2)}
        return params
