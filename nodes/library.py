"""The explicit list of our modules, in the order the library shows them, and what packages add."""

from __future__ import annotations

from functools import cache

from core.modules.declaration import Module, PackagedLibrary, library_of
from nodes.analysis.camera_geometry import CameraGeometry
from nodes.analysis.compare_images import CompareImages
from nodes.analysis.figures_of_merit import FiguresOfMerit
from nodes.analysis.image_quality import ImageQuality
from nodes.analysis.line_by_line import LineByLine
from nodes.analysis.measured_mtf import MeasuredMTF
from nodes.analysis.mtf_slices import MtfSlices
from nodes.analysis.noise_3d import Noise3D
from nodes.analysis.noise_budget import NoiseBudget
from nodes.analysis.spatial_blur import SpatialBlur
from nodes.atmosphere.atmosphere_mtf import AtmosphereMTF
from nodes.atmosphere.atmospheric_path import AtmosphericPath
from nodes.atmosphere.reflected_light import ReflectedLight
from nodes.detector.charge_eff_mtf import ChargeEffMTF
from nodes.detector.charge_eff_phase import ChargeEffPhase
from nodes.detector.detector_mtf import DetectorMTF
from nodes.detector.focal_plane import FocalPlane
from nodes.detector.microbolometer import Microbolometer
from nodes.detector.nuc import Nuc
from nodes.detector.spectral_response import SpectralResponse
from nodes.detector.tdi_mtf import TdiMTF
from nodes.electronics.electronics_noise import ElectronicsNoise
from nodes.electronics.noise_3d_source import Noise3DSource
from nodes.electronics.noise_file import NoiseFile
from nodes.electronics.periodic_noise import PeriodicNoise
from nodes.input_output.examine_image import ExamineImage
from nodes.input_output.read_image import ReadImage
from nodes.input_output.test_scene import TestScene
from nodes.input_output.write_image import WriteImage
from nodes.input_output.write_matrix import WriteMatrix
from nodes.motion.alongtrack_mtf import AlongtrackMTF
from nodes.motion.crosstrack_mtf import CrosstrackMTF
from nodes.motion.jitter_mtf import JitterMTF
from nodes.motion.line_of_sight import LineOfSight
from nodes.motion.relative_motion_mtf import RelativeMotionMTF
from nodes.motion.vibration_mtf import VibrationMTF
from nodes.optics.camera import Camera
from nodes.optics.diffraction_mtf import DiffractionMTF
from nodes.optics.exit_pupil import ExitPupil
from nodes.optics.exit_pupil_mtf import ExitPupilMTF
from nodes.optics.gaussian_mtf import GaussianMTF
from nodes.optics.mtf_file import MtfFile
from nodes.optics.poisson_noise import PoissonNoise
from nodes.optics.psf_file import PsfFile
from nodes.plug_ins import installed_plug_ins
from nodes.transform.anti_alias import AntiAlias
from nodes.transform.back_transform import BackTransform
from nodes.transform.combine_pixels import CombinePixels
from nodes.transform.init_trans import InitTrans
from nodes.transform.interpolate import Interpolate
from nodes.transform.sample_pixels import SamplePixels
from nodes.transform.to_radiance import ToRadiance
from nodes.transform.to_temperature import ToTemperature

MODULES: tuple[type[Module], ...] = (
    ReadImage,
    TestScene,
    WriteImage,
    WriteMatrix,
    ExamineImage,
    InitTrans,
    BackTransform,
    CombinePixels,
    SamplePixels,
    AntiAlias,
    Interpolate,
    ToRadiance,
    ToTemperature,
    ReflectedLight,
    AtmosphericPath,
    AtmosphereMTF,
    Camera,
    DiffractionMTF,
    ExitPupil,
    ExitPupilMTF,
    GaussianMTF,
    MtfFile,
    PsfFile,
    PoissonNoise,
    CrosstrackMTF,
    AlongtrackMTF,
    RelativeMotionMTF,
    JitterMTF,
    VibrationMTF,
    LineOfSight,
    DetectorMTF,
    ChargeEffMTF,
    ChargeEffPhase,
    TdiMTF,
    SpectralResponse,
    FocalPlane,
    Microbolometer,
    Nuc,
    ElectronicsNoise,
    PeriodicNoise,
    NoiseFile,
    Noise3DSource,
    MtfSlices,
    MeasuredMTF,
    FiguresOfMerit,
    NoiseBudget,
    Noise3D,
    CompareImages,
    SpatialBlur,
    LineByLine,
    CameraGeometry,
    ImageQuality,
)


@cache
def standard_library() -> PackagedLibrary:
    """Every module by its key: ours, then those of installed packages."""
    ours = library_of(MODULES)
    plug_ins = installed_plug_ins(ours)
    return PackagedLibrary({**ours, **library_of(plug_ins.modules)}, plug_ins.faults)
