"""Defaults are part of every network file: what a file leaves out has them, also years later.

Who changes one changes what saved networks give, and has to change it here too. New modules and new
parameters need not be here.
"""

import pytest

from module_defaults import DEFAULTS

FREE = {"apply": "multiply"}
SEED = {"seed_mode": "automatic", "seed": 0}
CHARGE = {
    **FREE, "detectors_per_line": 640, "efficiency": 0.99999, "model": "exact", "nyquist": "image",
}  # fmt: skip
RECORDED = {
    "read_image": {
        "bands": "one", "band": 0, "scale": 1.0, "offset": 0.0, "unit": "W/m²/sr",
        "missing": "refuse",
    },
    "test_scene": {
        "kind": "dormitory", "width": 512, "height": 512, "fov_x_deg": 30.0, "fov_y_deg": 30.0,
        "cut_on_um": 8.0, "cut_off_um": 12.0, "temperature_K": 303.15, "delta_K": 10.0,
        "angle_deg": 5.0, "frequency": 16.0, "bands": 0, "emissivity": "spectra",
        "sun_elevation_deg": 0.0,
    },
    "write_image": {"format": "by_suffix", "dtype": "automatic"},
    "write_matrix": {},
    "examine_image": {"display": "linear", "bins": 256},
    "init_trans": {
        "fill_x": 1.0, "fill_y": 1.0, "platform": "line", "velocity_m_per_s": 0.0,
        "scan_velocity_mrad_per_s": 0.0, "edges": "reflect",
    },
    "back_transform": {},
    "combine_pixels": {"factor_x": 2, "factor_y": 1, "mode": "mean"},
    "sample_pixels": {"offset": 0.0},
    "anti_alias": {"kernel": "box", "factor": 1},
    "interpolate": {"order": 1},
    "to_radiance": {"emissivity": 1.0},
    "to_temperature": {"emissivity": 1.0},
    "reflected_light": {
        "sun_elevation_deg": 45.0, "optical_depth": 0.0, "sky": 0.0, "bands": 1,
    },
    "atmospheric_path": {
        "model": "transmission", "transmission": 1.0, "extinction_per_km": 0.2,
        "visibility_km": 23.0, "angstrom_q": 0.0,
    },
    "spectral_response": {"shape": "rectangle", "peak": 1.0},
    "atmosphere_mtf": {
        **FREE, "turbulence": "gaussian", "fwhm_mrad": 0.0, "alpha": 0.5, "turbidity": "none",
        "turbidity_cutoff_cyc_per_mrad": 0.001, "view": "horizontal", "absorption_per_km": 0.0,
        "scattering_per_km": 0.0, "scale_height_km": 1.0,
    },
    "camera": {"obscuration_ratio": 0.0},
    "diffraction_mtf": {
        **FREE, "weighting": "photons", "wavelengths": "auto", "tolerance": 0.0,
        "defocus_waves": 0.0, "rms_wavefront_waves": 0.0,
    },
    "exit_pupil": {
        "shape": "clear", "size_x": 512, "size_y": 512, "obscuration_radius": 25.0,
        "slit_width": 20.0, "vanes": 3, "vane_width": 4.0, "defocus_waves": 0.0,
        "zernike_waves": [], "wavefront_unit": "waves",
    },
    "exit_pupil_mtf": {
        "weighting": "uniform",
        "size_x_cm": 25.6, "size_y_cm": 25.6, "method": "exact", "interpolation": "bilinear",
        "wavelengths": 1, **FREE,
    },
    "gaussian_mtf": {**FREE, "sigma_x_mrad": 0.0, "sigma_y_mrad": 0.0},
    "mtf_file": {
        **FREE, "frequency_unit": "file", "direction": "file", "normalise": "refuse", "field": 0,
    },
    "psf_file": {
        **FREE, "pitch_unit": "um", "centroid": "kept", "background": 0.0,
    },
    "poisson_noise": {**SEED, "width_px": 5.0, "percent": 1.0, "mode": "published"},
    "crosstrack_mtf": {**FREE, "dwell_time_s": 0.0},
    "alongtrack_mtf": {**FREE, "integration_time_s": 0.0},
    "relative_motion_mtf": {
        **FREE, "image_velocity_x": 0.0, "image_velocity_y": 0.0, "platform_velocity_x": 0.0,
        "platform_velocity_y": 0.0, "integration_time_s": 0.0, "model": "published",
    },
    "jitter_mtf": {**FREE, "sigma_mrad": 0.02},
    "vibration_mtf": {**FREE, "amplitude_x_mrad": 0.0, "amplitude_y_mrad": 0.0},
    "line_of_sight": {
        **FREE, **SEED, "rms_x_mrad": 0.0, "rms_y_mrad": 0.0, "corner_Hz": 5.0,
        "integration_time_s": 0.01, "frame_rate_Hz": 30.0,
    },
    "detector_mtf": FREE,
    "charge_eff_mtf": CHARGE,
    "charge_eff_phase": CHARGE,
    "tdi_mtf": {
        **FREE, "stages": 64, "phases": 4, "velocity_mismatch_percent": 0.0, "direction": "y",
    },
    "focal_plane": {
        **SEED, "integration_time_s": 0.001, "tdi_stages": 1, "frames_averaged": 1,
        "quantum_efficiency": 0.7, "photon_weighting": "scene", "source_K": 5800.0,
        "optics_transmission": 1.0, "cold_shield_efficiency": 1.0, "dark_current_e_per_s": 0.0,
        "rule_07": False, "nonlinearity_percent": 0.0, "read_noise_e": 0.0, "prnu_percent": 0.0,
        "dsnu_e": 0.0, "bad_pixel_percent": 0.0, "bits": 0, "offset_dn": 0.0, "units": "dn",
    },
    "microbolometer": {
        **SEED, "netd_mK": 50.0, "reference_f_number": 1.0, "reference_K": 300.0,
        "optics_transmission": 1.0, "time_constant_s": 0.01, "frame_rate_Hz": 30.0,
        "corner_Hz": 0.0, "longest_period_s": 60.0, "response_percent": 0.0, "offset_mK": 0.0,
    },
    "nuc": {
        **SEED, "method": "two_point", "low_K": 290.0, "high_K": 310.0, "reference_frames": 16,
        "drift_K": 0.0,
    },
    "electronics_noise": {
        **SEED, "region": "VIS", "material": "HgCdTe", "optics_transmission": 1.0,
        "filter_transmission": 1.0, "snr_reference": "mean", "gain_percent": 0.0,
        "bias_percent": 0.0, "gain_model": "per_pixel", "noise_variability_percent": 0.0,
        "use_mtf": False, "post_filter": "none", "post_poles": 1, "post_gain": 2.0, "bits": 0,
    },
    "periodic_noise": {
        "amplitude": 0.0, "xi": 0.1, "eta": 0.0, "phase_deg": 0.0, "modulation": 0.0,
        "modulation_xi": 0.01, "modulation_eta": 0.0, "modulation_phase_deg": 0.0,
    },
    "noise_file": {"band": 0, "scale": 1.0},
    "noise_3d_source": {
        **SEED, "sigma_tvh": 0.0, "sigma_tv": 0.0, "sigma_th": 0.0, "sigma_t": 0.0,
        "sigma_vh": 0.0, "sigma_v": 0.0, "sigma_h": 0.0, "corner_Hz": 0.0, "frame_rate_Hz": 30.0,
        "longest_period_s": 60.0,
    },
    "mtf_slices": {"direction": "horizontal", "angle_deg": 45.0, "samples": 257, "stages": True},
    "measured_mtf": {
        "method": "slanted_edge", "target": "edge", "direction": "automatic", "region_x": 0,
        "region_y": 0, "window": "tukey", "samples": 129, "axis": "cyc_per_mrad",
    },
    "figures_of_merit": {
        "model": "flir92", "scanning": "automatic", "snr_threshold": 2.5, "frame_rate_Hz": 30.0,
        "eye_integration_s": 0.2, "mdtd_window": "target", "target_size_m": 2.3,
        "target_delta_K": 2.0, "extinction_per_km": 0.2, "n50_detection": 0.75,
        "n50_recognition": 3.0, "n50_identification": 6.0, "ttp_threshold": "mrtd", "v50": 18.8,
        "scene_contrast_K": 5.0, "display_cd_m2": 34.0, "display_deg": 15.0,
    },
    "image_quality": {"off_nadir_deg": 0.0, "noise_gain": 1.0},
    "noise_budget": {"frequency": 0.5, "noise": "all", "show": "share"},
    "noise_3d": {"frames": 16},
    "compare_images": {"average": "axes", "edges": "reflect"},
    "spatial_blur": {"truncation": "half_width", "half_width_px": 16, "error": 0.001},
    "line_by_line": {
        "scan": "x", "look_angle_deg": 0.0, "spacing": "frame", "method": "nodes",
        "tolerance": 1e-05,
    },
    "camera_geometry": {
        "kind": "line", "altitude_m": 1000.0, "fov_x_deg": 20.0, "roll_deg": 0.0, "pitch_deg": 0.0,
        "yaw_deg": 0.0, "offset_x_m": 0.0, "offset_y_m": 0.0, "interpolation": "area", "strips": 4,
        "outside": "refuse", "fill_value": 0.0,
    },
}  # fmt: skip


@pytest.mark.parametrize("key", RECORDED)
def test_what_is_left_out_has_the_recorded_default(key):
    """What is not recorded was empty, taken from the input or the context, or is new since."""
    assert {name: DEFAULTS[key][name] for name in RECORDED[key]} == RECORDED[key]
