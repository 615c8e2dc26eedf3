"""Settings with which every registered module is tried."""

from typing import Any

from core.modules.declaration import declaration
from nodes.library import standard_library


class Examples(dict[str, dict[str, Any]]):
    """Of a module that is not listed, the first of its numbers that is 0 or empty, or the first."""

    def __missing__(self, key: str) -> dict[str, Any]:
        numbers = [p for p in declaration(standard_library()[key]).parameters if p.kind == "number"]
        for p in sorted(numbers, key=lambda p: bool(p.default)):
            low, high = p.param.slider or (p.param.low or 0.0, p.param.high or 10.0)
            return {p.name: low + 0.4 * (high - low)}
        return {}


# Parameters of a module's small example; what they are linked to follows from their port types.
EXAMPLES = Examples({
    "read_image": {"path": "noise.npy", "fov_x_deg": 1.5, "fov_y_deg": 1.1},
    "test_scene": {"width": 15, "height": 11, "fov_x_deg": 1.5, "fov_y_deg": 1.1},
    "write_image": {"path": "written.tif"},
    "write_matrix": {"path": "written.csv"},
    "examine_image": {"probe_x": 3, "probe_y": 4},
    "init_trans": {"detector_x_um": 30, "focal_length_mm": 50},
    "back_transform": {},
    "combine_pixels": {"factor_x": 3, "factor_y": 2},
    "sample_pixels": {"factor_x": 2.5, "factor_y": 2, "offset": 0.1},
    "anti_alias": {"factor": 3},
    "interpolate": {"width": 20, "height": 7},
    "to_radiance": {"emissivity": 0.9, "surroundings_K": 280},
    "to_temperature": {"emissivity": 0.9, "surroundings_K": 200},
    "reflected_light": {
        "sky": 20, "optical_depth": 0.3, "cut_on_um": 0.5, "cut_off_um": 0.9, "bands": 3,
    },
    "atmospheric_path": {
        "model": "visibility_km", "angstrom_q": 1, "range_m": 4000, "air_K": 285,
    },
    "spectral_response": {"shape": "gaussian", "peak": 0.8},
    "atmosphere_mtf": {"fwhm_mrad": 2, "turbidity": "high"},
    "camera": {
        "pixels_x": 15, "pixels_y": 11, "pitch_um": 50, "focal_length_mm": 30, "f_number": 2,
        "range_m": 700,
    },
    "diffraction_mtf": {"aperture_mm": 20, "obscuration_ratio": 0.3, "defocus_waves": 0.3},
    "exit_pupil": {"size_x": 32, "size_y": 32, "radius": 12, "obscuration_radius": 4},
    "exit_pupil_mtf": {"size_x_cm": 3, "size_y_cm": 4, "wavelengths": 3},
    "gaussian_mtf": {"sigma_x_mrad": 1, "sigma_y_mrad": 2},
    "mtf_file": {"path": "mtf.csv", "focal_length_mm": 40},
    "psf_file": {"path": "psf.txt", "sample_pitch": 0.4, "pitch_unit": "mrad"},
    "poisson_noise": {"percent": 50},
    "vignetting": {
        "measured": "polynomial", "against": "height_mm", "coefficients": [-0.3],
        "focal_length_mm": 50,
    },
    "distortion": {"k1": 20, "p1": 0.5, "centre_x_mrad": 1, "width": 13},
    "field_psf": {"tangential_mrad": [1, 2, 4], "sagittal_mrad": [1, 1, 2], "tile": 8},
    "veiling_glare": {"share_percent": 10},
    "microlens": {"chief_ray_deg": 25, "matched_deg": 5},
    "dual_gain": {"switch_level": 40, "blend_percent": 10, "low_factor": 0.9},
    "read_window": {"columns": 9, "rows": 7, "left": 1, "row_time_us": 10},
    "crosstalk": {"kernel": "0.01 0.03 0.01; 0.02 0.85 0.03; 0.01 0.03 0.01"},
    "charge_diffusion_mtf": {"absorption_per_um": 0.05, "diffusion_length_um": 300},
    "crosstrack_mtf": {"dwell_time_s": 1e-4},
    "alongtrack_mtf": {"integration_time_s": 0.01},
    "relative_motion_mtf": {
        "image_velocity_x": 5, "platform_velocity_y": 90, "integration_time_s": 0.01,
        "model": "line",
    },
    "jitter_mtf": {"sigma_mrad": 1},
    "vibration_mtf": {
        "amplitude_x_mrad": 1, "amplitude_y_mrad": 2, "frequency_Hz": 10,
        "integration_time_s": 0.13,
    },
    "line_of_sight": {"rms_x_mrad": 1, "rms_y_mrad": 2, "corner_Hz": 40},
    "detector_mtf": {},
    "charge_eff_mtf": {"efficiency": 0.999},
    "charge_eff_phase": {"efficiency": 0.999},
    "tdi_mtf": {"stages": 7, "phases": 3, "velocity_mismatch_percent": 4, "yaw_deg": 5},
    "focal_plane": {
        "integration_time_s": 1e-5, "optics_K": 290, "cold_shield_efficiency": 0.9,
        "housing_K": 300, "dark_current_e_per_s": 1e5, "full_well_e": 4e6, "read_noise_e": 300,
        "prnu_percent": 1, "dsnu_e": 200, "nonlinearity_percent": 1, "bad_pixel_percent": 3,
        "bits": 12, "offset_dn": 10, "charge_gain": "photoconductive", "charge_gain_factor": 0.5,
    },
    "microbolometer": {
        "netd_mK": 80, "corner_Hz": 2, "longest_period_s": 5, "response_percent": 2,
        "offset_mK": 300,
    },
    "nuc": {},
    "blooming": {"full_well": 42},
    "charge_trails": {
        "serial_efficiency": 0.999, "parallel_efficiency": 0.99, "amplifier": "top_right",
        "extra_serial": 20,
    },
    "electronics_noise": {
        "region": "LWIR", "scan_mirror_rate_Hz": 1, "amplifier_snr": 30, "gain_percent": 1,
        "bias_percent": 1, "noise_variability_percent": 10, "use_mtf": True,
        "post_filter": "lowpass", "post_corner_Hz": 2000, "bits": 8,
    },
    "periodic_noise": {"amplitude": 2, "modulation": 0.5},
    "noise_file": {"path": "noise.npy", "scale": 0.1},
    "noise_3d_source": {
        "sigma_tvh": 0.1, "sigma_tv": 0.2, "sigma_h": 0.3, "corner_Hz": 2, "longest_period_s": 5,
    },
    "mtf_slices": {"direction": "both", "samples": 9},
    "compare_images": {},
    "measured_mtf": {"region_width": 40, "samples": 9},
    "spatial_blur": {"truncation": "none"},
    "line_by_line": {"look_angle_deg": 30},
    "figures_of_merit": {"frame_rate_Hz": 25},
    "image_quality": {"range_m": 5000, "off_nadir_deg": 20},
    "noise_3d": {"frames": 3},
    "noise_budget": {"frequency": 0.7},
    "camera_geometry": {"fov_x_deg": 1.1, "columns": 9, "rows": 7},
})  # fmt: skip

# Settings at which a module passes its input on; several where there are several ways to say so.
NEUTRAL: dict[str, list[dict[str, Any]]] = {
    "combine_pixels": [{"factor_x": 1, "factor_y": 1}],
    "sample_pixels": [{"factor_x": 1, "factor_y": 1}],
    "anti_alias": [{}, {"kernel": "lanczos", "factor": 1}],
    "interpolate": [{}, {"width": 15, "height": 11, "order": 3}],
    "atmospheric_path": [
        {}, {"air_K": 285}, {"model": "extinction_per_km", "extinction_per_km": 0},
    ],
    "spectral_response": [{}],
    "atmosphere_mtf": [
        {}, {"turbulence": "none"}, {"turbidity": "custom"},
        {"turbidity": "custom", "absorption_per_km": 3, "view": "vertical"},
    ],
    "camera": [{}, {"pitch_um": 7, "focal_length_mm": 40}],
    "exit_pupil_mtf": [{"interpolation": "none"}],
    "vignetting": [{"natural": False}, {"natural": False, "against": "height_mm"}],
    "distortion": [{}, {"centre_x_mrad": 3, "width": 15}],
    "field_psf": [{}, {"tangential_mrad": [0, 0, 0], "tile": 9}],
    "veiling_glare": [{}, {"form": "harvey", "share_percent": 5}],
    "microlens": [{}, {"chief_ray_deg": 12, "matched_deg": 12}],
    "read_window": [{}, {"columns": 15, "left": 0, "row_time_us": 20}],
    "gaussian_mtf": [{}, {"sigma_x_mrad": 0, "sigma_y_mrad": 0.0}],
    "mtf_file": [{}, {"direction": "x", "normalise": "at_zero"}],
    "psf_file": [{}, {"centroid": "removed", "sample_pitch": 3}],
    "poisson_noise": [{"percent": 0}],
    "crosstrack_mtf": [{}, {"dwell_time_s": 0, "scan_velocity_mrad_per_s": 7}],
    "alongtrack_mtf": [{}, {"velocity_m_per_s": 30}],
    "relative_motion_mtf": [
        {},
        {"image_velocity_x": 5, "platform_velocity_x": 5, "integration_time_s": 1},
        {"image_velocity_x": 5, "model": "line"},
    ],
    "jitter_mtf": [{"sigma_mrad": 0}],
    "vibration_mtf": [{}, {"frequency_Hz": 5, "integration_time_s": 1}],
    "line_of_sight": [{}, {"corner_Hz": 3, "frame_rate_Hz": 5}],
    "charge_eff_mtf": [{"efficiency": 1}, {"detectors_per_line": 0}],
    "charge_eff_phase": [{"efficiency": 1}, {"detectors_per_line": 0, "model": "published"}],
    "tdi_mtf": [{"phases": 0}, {"phases": 0, "stages": 9, "direction": "x"}],
    "rolling_shutter": [{}, {"image_velocity_x": 9, "line_time_s": 0}],
    "frame_transfer_smear": [{}, {"passed": "above"}],
    "blooming": [{}, {"anti_blooming_percent": 50}],
    "charge_trails": [{}, {"extra_serial": 9, "extra_parallel": 7}],
    "persistence": [{}, {"delay_s": 3}],
    "nuc": [{}, {"method": "none", "low_K": 400}],
    "periodic_noise": [{"amplitude": 0}],
    "noise_file": [{"path": "noise.npy", "scale": 0}],
    "noise_3d_source": [{}, {"sigma_v": 0, "longest_period_s": 1e-9}],
}  # fmt: skip

PUPILS: dict[str, dict[str, Any]] = {
    "clear": {},
    "half_moon": {"shape": "half_moon"},
    "cassegrain": {"shape": "cassegrain"},
    "hinged": {"shape": "hinged"},
    "cassegrain_slit": {"shape": "cassegrain_slit"},
    "spider": {"shape": "spider"},
    "defocus": {"defocus_waves": 0.7},
    "defocused ring": {"shape": "cassegrain", "defocus_waves": 1.2},
    "coma": {"zernike_waves": [0, 0, 0, 0.1, 0, 0, 0.2, 0.15]},
}
SENSOR = {
    "detector_x_um": 30, "detector_y_um": 25, "focal_length_mm": 50, "f_number": 2, "range_m": 500,
    "velocity_m_per_s": 100, "scan_velocity_mrad_per_s": 5000,
}  # fmt: skip
SMALL_PUPIL = {
    "size_x": 32, "size_y": 32, "radius": 12, "obscuration_radius": 4, "slit_width": 3,
    "vane_width": 2,
}  # fmt: skip
SCAN = {"region": "LWIR", "scan_mirror_rate_Hz": 1}
POST = {"post_corner_Hz": 1500}

# What every filter is tried with, beside its example and what hypothesis draws.
SETTINGS: dict[str, list[dict[str, Any]]] = {
    "atmosphere_mtf": [
        {"turbulence": "long_exposure", "fried_r0_m": 0.01},
        {"turbulence": "long_exposure", "cn2": 1e-13},
        {"turbulence": "long_exposure", "cn2": 1e-13, "view": "vertical"},
        {"turbulence": "long_exposure", "cn2": 1e-13, "view": "up"},
        {"turbulence": "short_exposure", "fried_r0_m": 0.01, "aperture_mm": 5, "alpha": 1},
        {"turbulence": "short_exposure", "fried_r0_m": 1e-6, "aperture_mm": 5},
        {"turbulence": "none", "turbidity": "custom", "scatter_depth": 700},
        {"turbulence": "none", "turbidity": "custom", "scattering_per_km": 3, "view": "vertical"},
        {"turbidity": "low", "turbidity_cutoff_cyc_per_mrad": 1e6},
        {"turbidity": "high", "particle_radius_um": 800},
        {"turbulence": "long_exposure", "fried_r0_m": 1e-3, "r0_wavelength_um": 0.5},
    ],
    "exit_pupil_mtf": [
        {},
        *({"size_x_cm": 3, "size_y_cm": 2, "wavelengths": n} for n in (2, 3, 4, 5, 7, 11)),
        {"method": "autocorrelation", "size_x_cm": 3, "size_y_cm": 3},
        {"method": "autocorrelation", "interpolation": "linear", "wavelengths": 2},
    ],
    "diffraction_mtf": [
        {}, {"aperture_mm": 1e-3}, {"aperture_mm": 1e4, "source_K": 6000},
        {"rms_wavefront_waves": 0.08, "weighting": "energy"},
        {"defocus_waves": -3, "weighting": "uniform", "wavelengths": 5},
        {"obscuration_ratio": 0.99, "defocus_waves": 2},
    ],
    "gaussian_mtf": [{"sigma_y_mrad": 1e9}, {"sigma_x_mrad": 1e-9}],
    "veiling_glare": [
        {"form": "harvey", "b_per_sr": 3, "s": s, "l_mrad": 2, "surfaces": 5} for s in (-2.3, -1)
    ],
    "mtf_file": [
        {"path": "round.csv"}, {"path": "round.csv", "direction": "x"},
        {"path": "round.csv", "frequency_unit": "cyc/mrad", "direction": "y"},
        {"path": "mtf.csv", "direction": "x", "normalise": "at_zero"},
    ],
    "psf_file": [
        {"path": "psf.txt", "sample_pitch": 20, "sample_pitch_y": 9, "focal_length_mm": 40},
        {"path": "psf.txt", "sample_pitch": 3, "pitch_unit": "mrad", "centroid": "removed"},
        {"path": "psf.txt", "sample_pitch": 0.01, "pitch_unit": "mrad", "background": 0.5},
    ],
    "crosstrack_mtf": [{"dwell_time_s": 1, "scan_velocity_mrad_per_s": 1e6}],
    "alongtrack_mtf": [{"velocity_m_per_s": -4000, "integration_time_s": 1, "range_m": 3}],
    "relative_motion_mtf": [
        {"image_velocity_x": 9, "platform_velocity_y": 4, "integration_time_s": 1},
        {
            "image_velocity_x": -9e4, "platform_velocity_y": 4, "integration_time_s": 1,
            "model": "line",
        },
        {"image_velocity_x": -9, "integration_time_s": 1, "model": "line"},
    ],
    "vibration_mtf": [
        {"amplitude_x_mrad": 3},
        {"amplitude_y_mrad": 3, "frequency_Hz": 1, "integration_time_s": 4},
        {"amplitude_x_mrad": 3, "frequency_Hz": 1, "integration_time_s": 1e-6},
        {"amplitude_x_mrad": 300, "frequency_Hz": 7, "integration_time_s": 1.23},
    ],
    "line_of_sight": [
        {"rms_x_mrad": 1e6, "corner_Hz": 1e9, "integration_time_s": 1e6},
        {"rms_y_mrad": 3, "integration_time_s": 0},
        {"rms_x_mrad": 3, "corner_Hz": 1e-6},
    ],
    "detector_mtf": [{"detector_x_um": 1e5, "fill_y": 1e-6}, {"focal_length_mm": 1e-3}],
    "charge_eff_mtf": [
        {"efficiency": 0, "detectors_per_line": 3},
        {"efficiency": 0.5, "detectors_per_line": 1000000},
        {"efficiency": 0.9, "model": "published", "nyquist": "detector"},
        {"efficiency": 0.9, "model": "leading"},
    ],
    "charge_eff_phase": [
        {"efficiency": 0, "detectors_per_line": 3},
        {"efficiency": 0.5, "detectors_per_line": 1000000},
        {"efficiency": 0.9, "model": "published", "nyquist": "detector"},
        {"efficiency": 0.9, "model": "leading"},
    ],
    "tdi_mtf": [
        {"phases": 0, "velocity_mismatch_percent": 30, "direction": "x"},
        {"stages": 10000, "phases": 100, "velocity_mismatch_percent": 1000},
        {"stages": 2, "phases": 1, "velocity_mismatch_percent": -99},
        {"stages": 9, "yaw_deg": -20},
        {"phases": 0, "velocity_mismatch_percent": 30, "direction": "x", "yaw_deg": 60},
    ],
    "electronics_noise": [
        {**SCAN, "use_mtf": True},
        {**SCAN, "use_mtf": True, "time_constant_s": 10},
        {**SCAN, "post_filter": "lowpass", "post_poles": 4, **POST},
    ],
}  # fmt: skip
NOT_PASSIVE = [
    {**SCAN, "post_filter": "highpass", **POST},
    {**SCAN, "post_filter": "boost", "post_gain": 9, **POST},
]
# Where the declared range is that of a large machine, not of a test.
AFFORDABLE = {
    "width": (1, 40), "height": (1, 40), "wavelengths": (1, 6), "size_x": (2, 48),
    "size_y": (2, 48), "factor": (1, 60), "factor_x": (1, 6), "factor_y": (1, 6), "vanes": (0, 9),
}  # fmt: skip
