"""Which parameters stand together on the panel of each module, in the order of the 1996 panels."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from app.editor.panels.layouts_electronics import ELECTRONICS
from app.editor.panels.sections import Section, complete, plain_layout
from core.modules.declaration import Declaration
from core.physics.optics.pupil_shapes import BARRED_SHAPES, OBSCURED_SHAPES, SHAPES

Layout = tuple[Section, ...]


def layout_of(declaration: Declaration) -> Layout:
    """The sections of a module's panel; every parameter stands in one of them, once."""
    known = _LAYOUTS.get(declaration.key)
    if known is None:
        return plain_layout(declaration) if declaration.parameters else ()
    return complete(known, declaration)


_APPLY = Section("", ("apply",))
_FIELD_OF_VIEW = Section("Field of view", ("fov_x_deg", "fov_y_deg"))
_BAND = Section("Band", ("cut_on_um", "cut_off_um"))
_SEED = (
    Section("Seed", ("seed_mode",)),
    Section("", ("seed",), shown_when=("seed_mode", ("typed",))),
)

_READ_IMAGE = (
    Section("File", ("path", "band", "scale", "unit", "missing")),
    _FIELD_OF_VIEW,
    _BAND,
)
_TEST_SCENE = (
    Section("Scene", ("kind", "width", "height")),
    Section("Temperatures", ("temperature_K", "delta_K")),
    Section("Pattern", ("angle_deg",), shown_when=("kind", ("slanted_edge", "sine"))),
    Section("", ("frequency",), shown_when=("kind", ("four_bar", "siemens_star", "sine"))),
    _FIELD_OF_VIEW,
    _BAND,
)
_WRITE_IMAGE = (
    Section("File", ("path", "format", "dtype")),
    Section("Range of integer types", ("range_low", "range_high")),
)
_EXAMINE_IMAGE = (
    Section("", ("display",)),
    Section("Pixel probe", ("probe_x", "probe_y")),
    Section("Histogram", ("bins",)),
)
_INIT_TRANS = (
    Section(
        "Detector and optics",
        (
            "detector_x_um",
            "detector_y_um",
            "focal_length_mm",
            "f_number",
            "range_m",
            "fill_x",
            "fill_y",
        ),
    ),
    _FIELD_OF_VIEW,
    Section("Collection", ("platform", "velocity_m_per_s", "scan_velocity_mrad_per_s")),
    Section("Fourier transform", ("edges",)),
)
_FRIED = ("long_exposure", "short_exposure")
_ATMOSPHERE = (
    _APPLY,
    Section("Turbulence", ("turbulence",)),
    Section("", ("fwhm_mrad",), shown_when=("turbulence", ("gaussian",))),
    Section("", ("fried_r0_m", "cn2", "wavelength_um"), shown_when=("turbulence", _FRIED)),
    Section("", ("aperture_mm", "alpha"), shown_when=("turbulence", ("short_exposure",))),
    Section("Turbidity", ("turbidity",)),
    Section(
        "",
        ("turbidity_cutoff_cyc_per_mrad",),
        shown_when=("turbidity", ("low", "moderate", "high", "custom")),
    ),
    Section(
        "",
        ("scatter_depth", "absorption_per_km", "scattering_per_km", "scale_height_km"),
        shown_when=("turbidity", ("custom",)),
    ),
    Section("Path", ("view",)),
)
_EXIT_PUPIL = (
    Section("Aperture", ("shape", "radius")),
    Section("", ("obscuration_radius",), shown_when=("shape", OBSCURED_SHAPES)),
    Section("", ("slit_width",), shown_when=("shape", BARRED_SHAPES)),
    Section("", ("vanes", "vane_width"), shown_when=("shape", ("spider",))),
    Section("", ("path",), shown_when=("shape", ("file",))),
    Section("Pupil array", ("size_x", "size_y"), shown_when=("shape", SHAPES)),
    Section("Wavefront error", ("defocus_waves", "zernike_waves")),
)
_EXIT_PUPIL_MTF = (
    Section("Wavelengths", ("cut_on_um", "cut_off_um", "wavelengths")),
    Section("Whole pupil array", ("size_x_cm", "size_y_cm")),
    Section("Autocorrelation", ("interpolation", "method")),
    Section("Output", ("apply",)),
)
_POISSON = (
    Section("", ("mode",)),
    Section("", ("width_px", "percent"), shown_when=("mode", ("published",))),
    Section("", ("photons_per_unit",), shown_when=("mode", ("photon",))),
    *_SEED,
)
_RELATIVE_MOTION = (
    _APPLY,
    Section("Image", ("image_velocity_x", "image_velocity_y")),
    Section("Platform", ("platform_velocity_x", "platform_velocity_y")),
    Section("Smear", ("integration_time_s", "range_m", "model")),
)
_DETECTOR = (
    _APPLY,
    Section("Detector", ("detector_x_um", "detector_y_um", "focal_length_mm")),
    Section("Fill factors", ("fill_x", "fill_y")),
)
_CHARGE = (
    _APPLY,
    Section("Charge transfer", ("detectors_per_line", "efficiency", "model", "nyquist")),
)
_PERIODIC = (
    Section("Sinusoid", ("amplitude", "xi", "eta", "phase_deg")),
    Section(
        "Modulation", ("modulation", "modulation_xi", "modulation_eta", "modulation_phase_deg")
    ),
)
_SLICES = (
    Section("Line of frequencies", ("direction",)),
    Section("", ("angle_deg",), shown_when=("direction", ("angle",))),
    Section("Curves", ("stages", "samples")),
)
_SPATIAL = (
    Section("Kernels", ("truncation",)),
    Section("", ("half_width_px",), shown_when=("truncation", ("half_width",))),
    Section("", ("error",), shown_when=("truncation", ("error",))),
)
_LINES_FLOWN = ("line", "pushbroom")
_CAMERA = (
    Section("Camera", ("kind", "altitude_m", "columns", "rows"), page="Camera"),
    Section("Samples", ("fov_x_deg", "pitch_x_um", "pitch_y_um", "focal_length_mm"), page="Camera"),
    Section(
        "Flight",
        ("velocity_m_per_s", "line_rate_Hz"),
        page="Camera",
        shown_when=("kind", _LINES_FLOWN),
    ),
    Section("Attitude", ("roll_deg", "pitch_deg", "yaw_deg"), page="Attitude"),
    Section(
        "Scene",
        ("ground_interval_m", "ground_interval_y_m", "offset_x_m", "offset_y_m"),
        page="Scene",
    ),
    Section("Sampling", ("interpolation", "strips", "outside"), page="Scene"),
    Section("", ("fill_value",), page="Scene", shown_when=("outside", ("fill",))),
)
_LINES = (
    Section("Scan", ("scan", "look_angle_deg", "nadir_column")),
    Section("Scan lines on the ground", ("spacing",)),
    Section("", ("line_spacing_m",), shown_when=("spacing", ("typed",))),
    Section("", ("altitude_m",), shown_when=("spacing", ("typed", "flight"))),
    Section("Apertures and other planar factors", ("method",)),
    Section("", ("nodes", "tolerance"), shown_when=("method", ("nodes",))),
)
_MEASURED = (
    Section("", ("method", "target", "direction")),
    Section("Region", ("region_x", "region_y", "region_width", "region_height")),
    Section("Slanted edge", ("window", "samples"), shown_when=("method", ("slanted_edge",))),
    Section(
        "Level ends", ("clip_left_px", "clip_right_px"), shown_when=("method", ("row_average",))
    ),
    Section("Curve", ("axis",)),
)
_MERIT = (
    Section("", ("model", "scanning", "snr_threshold"), page="Sensor"),
    Section("Noise", ("cut_on_um", "cut_off_um", "background_K"), page="Sensor"),
    Section("In time", ("frame_rate_Hz", "eye_integration_s"), page="Eye"),
    Section("MDTD", ("mdtd_window", "eye_limit_mrad"), page="Eye"),
    Section(
        "Target",
        ("target_size_m", "target_delta_K", "extinction_per_km", "range_max_km"),
        page="Target",
    ),
    Section("Johnson", ("n50_detection", "n50_recognition", "n50_identification"), page="Target"),
    Section("Task and scene", ("v50", "scene_contrast_K"), page="TTP"),
    Section("Display", ("display_cd_m2", "display_deg", "magnification"), page="TTP"),
)
_NOISE_3D = (Section("Measurement", ("frames",)),)
_BUDGET = (Section("Noise and blur", ("noise", "frequency", "show")),)

_LAYOUTS: Mapping[str, Layout] = MappingProxyType(
    {
        "read_image": _READ_IMAGE,
        "test_scene": _TEST_SCENE,
        "write_image": _WRITE_IMAGE,
        "examine_image": _EXAMINE_IMAGE,
        "init_trans": _INIT_TRANS,
        "atmosphere_mtf": _ATMOSPHERE,
        "exit_pupil": _EXIT_PUPIL,
        "exit_pupil_mtf": _EXIT_PUPIL_MTF,
        "poisson_noise": _POISSON,
        "relative_motion_mtf": _RELATIVE_MOTION,
        "detector_mtf": _DETECTOR,
        "charge_eff_mtf": _CHARGE,
        "charge_eff_phase": _CHARGE,
        "electronics_noise": ELECTRONICS,
        "periodic_noise": _PERIODIC,
        "mtf_slices": _SLICES,
        "measured_mtf": _MEASURED,
        "figures_of_merit": _MERIT,
        "spatial_blur": _SPATIAL,
        "noise_3d": _NOISE_3D,
        "noise_budget": _BUDGET,
        "line_by_line": _LINES,
        "camera_geometry": _CAMERA,
    }
)
