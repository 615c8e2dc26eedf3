"""The list of our modules, in the order the library shows them, and what packages add."""

from functools import cache
from importlib import import_module

from core.modules.declaration import Module, PackagedLibrary
from nodes.plug_ins import installed_plug_ins

# A line for each: its folder, and its file, which is named as its key.
_FILES = (
    "input_output.read_image",
    "input_output.test_scene",
    "input_output.write_image",
    "input_output.write_matrix",
    "input_output.examine_image",
    "transform.init_trans",
    "transform.back_transform",
    "transform.combine_pixels",
    "transform.sample_pixels",
    "transform.anti_alias",
    "transform.interpolate",
    "transform.to_radiance",
    "transform.to_temperature",
    "atmosphere.reflected_light",
    "atmosphere.atmospheric_path",
    "atmosphere.atmosphere_mtf",
    "optics.camera",
    "optics.diffraction_mtf",
    "optics.exit_pupil",
    "optics.exit_pupil_mtf",
    "optics.vignetting",
    "optics.distortion",
    "optics.field_psf",
    "optics.veiling_glare",
    "optics.gaussian_mtf",
    "optics.mtf_file",
    "optics.psf_file",
    "motion.crosstrack_mtf",
    "motion.alongtrack_mtf",
    "motion.relative_motion_mtf",
    "motion.jitter_mtf",
    "motion.vibration_mtf",
    "motion.line_of_sight",
    "detector.detector_mtf",
    "detector.charge_diffusion_mtf",
    "detector.crosstalk",
    "detector.charge_eff_mtf",
    "detector.charge_eff_phase",
    "detector.tdi_mtf",
    "detector.spectral_response",
    "detector.microlens",
    "detector.focal_plane",
    "detector.microbolometer",
    "detector.nuc",
    "detector.dual_gain",
    "detector.read_window",
    "detector.rolling_shutter",
    "detector.frame_transfer_smear",
    "detector.blooming",
    "detector.charge_trails",
    "detector.persistence",
    "electronics.poisson_noise",
    "electronics.electronics_noise",
    "electronics.periodic_noise",
    "electronics.noise_file",
    "electronics.noise_3d_source",
    "analysis.mtf_slices",
    "analysis.measured_mtf",
    "analysis.figures_of_merit",
    "analysis.noise_budget",
    "analysis.noise_3d",
    "analysis.compare_images",
    "analysis.spatial_blur",
    "analysis.line_by_line",
    "analysis.camera_geometry",
    "analysis.image_quality",
)


OURS = {file.rpartition(".")[2]: file for file in _FILES}
"""By key, the file that a module of ours is in."""


def our_module(key: str) -> type[Module]:
    """A module of ours; only the files it needs are loaded."""
    for found in vars(import_module(f"nodes.{OURS[key]}")).values():
        if isinstance(found, type) and issubclass(found, Module) and found.key == key:
            return found
    raise ImportError(f"nodes/{OURS[key].replace('.', '/')}.py has no module with the key {key}")


@cache
def standard_library() -> PackagedLibrary:
    plug_ins = installed_plug_ins(OURS)
    brought = {module.key: module for module in plug_ins.modules}
    return PackagedLibrary(
        (*OURS, *brought), lambda key: brought.get(key) or our_module(key), plug_ins.faults
    )
