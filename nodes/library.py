"""The list of our modules, in the order the library shows them, and what packages add."""

import re
from collections.abc import Mapping
from functools import cache
from importlib import import_module
from threading import RLock
from typing import TYPE_CHECKING, Any

from core.errors import in_line, plug_ins, with_place
from core.modules.declaration import (
    Library,
    Module,
    PackagedLibrary,
    declaration,
    local_key,
    package_of,
)

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

# A line for each: its folder, and its file, which is named as its key; else the key stands behind.
_FILES = (
    "input_output.read_image",
    "input_output.test_scene",
    "input_output.write_image",
    "input_output.write_image:write_matrix",
    "input_output.examine_image",
    "transform.init_trans",
    "transform.init_trans:back_transform",
    "transform.resampling:combine_pixels",
    "transform.resampling:sample_pixels",
    "transform.resampling:anti_alias",
    "transform.resampling:interpolate",
    "transform.radiometry:to_radiance",
    "transform.radiometry:to_temperature",
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
    "optics.veiling_glare:gaussian_mtf",
    "optics.mtf_file",
    "optics.psf_file",
    "motion.motion_mtf:crosstrack_mtf",
    "motion.motion_mtf:alongtrack_mtf",
    "motion.motion_mtf:relative_motion_mtf",
    "motion.jitter_mtf",
    "motion.motion_mtf:vibration_mtf",
    "motion.line_of_sight",
    "detector.detector_mtf",
    "detector.detector_mtf:charge_diffusion_mtf",
    "detector.detector_mtf:crosstalk",
    "detector.detector_mtf:charge_eff_mtf",
    "detector.detector_mtf:charge_eff_phase",
    "detector.detector_mtf:tdi_mtf",
    "detector.spectral_response",
    "optics.vignetting:microlens",
    "detector.focal_plane",
    "detector.microbolometer",
    "detector.nuc",
    "detector.windows_and_gains:dual_gain",
    "detector.windows_and_gains:read_window",
    "detector.readout:rolling_shutter",
    "detector.readout:frame_transfer_smear",
    "detector.readout:blooming",
    "detector.readout:charge_trails",
    "detector.readout:persistence",
    "electronics.noise_sources:poisson_noise",
    "electronics.electronics_noise",
    "electronics.noise_sources:periodic_noise",
    "electronics.noise_sources:noise_file",
    "electronics.noise_sources:noise_3d_source",
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

OURS = {
    key or file.rpartition(".")[2]: file
    for file, _, key in (line.partition(":") for line in _FILES)
}
"""By key, the file that a module of ours is in."""

_LOADING = RLock()


def our_module(key: str) -> type[Module]:
    """A module of ours; only the files it needs are loaded."""
    with _LOADING:  # of two threads that load one package at once, one may not find it
        loaded = import_module(f"nodes.{OURS[key]}")
    for found in vars(loaded).values():
        if isinstance(found, type) and issubclass(found, Module) and found.key == key:
            return found
    raise ImportError(f"nodes/{OURS[key].replace('.', '/')}.py has no module with the key {key}")


@cache
def standard_library() -> PackagedLibrary:
    brought, faults = installed_plug_ins()
    return PackagedLibrary(
        (*OURS, *brought), lambda key: brought.get(key) or our_module(key), faults
    )


# Modules that other installed packages bring, by their entry points.
#
# A package names them in its ``pyproject.toml``::
#
#     [project.entry-points."imagechain.modules"]
#     flare = "acme_optics.flare:Flare"
#
# An entry point is a module's class, or several of them. Their keys begin with the package's name,
# as Python writes it, and a dot: ``acme_optics.flare``.


def installed_plug_ins() -> tuple[dict[str, type[Module]], dict[str, str]]:
    """Modules by key of installed packages, and faults by package, which keep out its own alone."""
    modules: dict[str, type[Module]] = {}
    faults: dict[str, str] = {}
    for point in sorted(plug_ins(), key=lambda one: (_package(one), one.name)):
        package = _package(point)
        try:
            for module in _modules_at(point, package):
                if module.key in OURS or module.key in modules:
                    raise TypeError(f"two modules have the key {module.key}")
                modules[module.key] = module
        except (Exception, SystemExit) as error:  # whatever code of others may raise
            faults.setdefault(package, f"{point.value} cannot be loaded: {with_place(error)}")
    return modules, faults


def missing_modules(library: Library) -> list[str]:
    faults = library.faults if isinstance(library, PackagedLibrary) else {}
    return [
        in_line(f"modules of the package {package} are missing: {fault}")
        for package, fault in faults.items()
    ]


def _package(point: "EntryPoint") -> str:
    name = point.dist.name if point.dist is not None else point.module.partition(".")[0]
    return re.sub(r"[-_.]+", "_", name).lower()


def _modules_at(point: "EntryPoint", package: str) -> tuple[type[Module], ...]:
    loaded: Any = point.load()
    if isinstance(loaded, Mapping):
        loaded = loaded.values()
    several = (loaded,) if isinstance(loaded, type) else tuple(loaded)
    for module in several:
        if not (isinstance(module, type) and issubclass(module, Module)):
            raise TypeError(f"{module!r:.80} is not a subclass of Module")
        local = local_key(module.key)
        if package_of(module.key) != package or not local.isidentifier():
            wanted = f"{package}.{local if local.isidentifier() else 'name'}"
            raise TypeError(
                f"the key of {module.__name__} is {module.key!r}, but must be {wanted!r}"
            )
        if not (module.title and module.group):
            raise TypeError(f"{module.__name__} has no title or no group")
        declaration(module)
    return several
