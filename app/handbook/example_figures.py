"""What the handbook computes: an example of every module, and published cameras."""

import base64
import html
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import networks
from app.report.drawing.curves import draw_on
from app.report.drawing.picture_drawing import figure, number, short
from app.run.evaluation import block_means
from app.run.saving import encode_png, grey_levels, robust_limits
from app.run.shipped import published_networks
from core.arrays import Array
from core.chain.engine import Engine, Plan
from core.chain.wires import Curve, CurveData, Image, Pupil, Series, Transfer
from core.errors import ImagechainError, in_line, thaw
from core.evaluation.work import Policy, Work
from core.modules.declaration import Declaration, Library, declaration
from core.network.file import load_network
from core.network.network import Link, Network, Node, reached

_WIDE, _HIGH = 5.2, 3.2  # inches of a plot
_SMALLEST_PHASE = 1e-9
_ALIKE = 2e-3
_MOST_CURVES = 3
_LARGEST = 640  # samples; of a larger picture the means of blocks are shown
_LARGE = 240  # samples; a smaller picture is shown by larger squares


def example_of(declared: Declaration, engine: Engine) -> dict[str, Any]:
    """The drawings of a module's example as pieces of a page, or why there are none."""
    if declared.key in NO_EXAMPLE:
        return {"reason": NO_EXAMPLE[declared.key]}
    network = example_network(declared, engine.library)
    plan = engine.plan(network, folder=SHIPPED)
    work = engine.work(Policy())
    try:
        drawings = _drawings(declared, engine, plan, work)
        units = {readout.name: readout.unit for readout in declared.readouts}
        readouts = [
            (name, _shown(value), units.get(name, ""))
            for name, value in engine.readouts(plan, IT, work).items()
            if value is not None
        ]
    except Exception as error:
        # A plug-in's module may need more than the nodes that stand before it here, or be at fault:
        # its page states it, and the others are made.
        kind = "" if isinstance(error, ImagechainError) else f"{type(error).__name__}: "
        return {"reason": f"The example on this page failed: {kind}{in_line(str(error))}."}
    settings = [(name, _shown(value)) for name, value in network.nodes[IT].params.items()]
    # Curves, and below them pictures.
    drawn = [drawing for drawing in drawings if 'class="curve"' in drawing[:40]]
    rows = [row for row in (drawn, [one for one in drawings if one not in drawn]) if row]
    return {"reason": "", "settings": settings, "rows": rows, "readouts": readouts}


def _drawings(declared: Declaration, engine: Engine, plan: Plan, work: Work) -> list[str]:
    outputs = plan.nodes[IT].outputs
    shown: list[str] = []
    for name in ("mtf", "ptf"):
        if isinstance(outputs.get(name), Transfer):
            drawing = _transfer(outputs[name], engine.value(plan, f"{IT}.{name}", work))
            shown += [drawing] if drawing else []
    drawn = [name for name, value in outputs.items() if isinstance(value, Curve)]
    for name in drawn[:_MOST_CURVES]:
        data = engine.value(plan, f"{IT}.{name}", work)
        shown.append(curves(data, data.title))
    for name, value in outputs.items():
        if isinstance(value, Pupil):
            samples = engine.value(plan, f"{IT}.{name}", work)
            shown.append(picture(np.abs(samples), "the pupil; white areas transmit light"))
    if declared.key == "init_trans":
        spectrum = np.fft.fftshift(np.abs(engine.value(plan, f"{IT}.magnitude", work)))
        return [*shown, picture(np.log(spectrum + 1e-6), "logarithm of the magnitude")]
    return shown + _before_and_after(plan, engine, work)


def _before_and_after(plan: Plan, engine: Engine, work: Work) -> list[str]:
    after = "seen.image" if "seen" in plan.nodes else f"{IT}.image"
    if not isinstance(plan.nodes[after.partition(".")[0]].outputs.get("image"), Image):
        return []
    made = plan.output(after)
    taking = "init" if "seen" in plan.nodes else IT, "image"
    links = (link for link in plan.network.links if (link.target, link.input) == taking)
    before = next((f"{link.source}.{link.output}" for link in links), None)
    samples = engine.value(plan, after, work)
    if before is None:
        return [picture(samples, f"the picture ({made.unit or 'no unit'})")]
    given, first = plan.output(before), engine.value(plan, before, work)
    same = made.unit == given.unit
    limits = robust_limits(first)
    drawings = [
        picture(first, f"before ({given.unit})", limits),
        picture(samples, f"after ({made.unit or 'no unit'})", limits if same else None),
    ]
    noise = plan.nodes[IT].outputs.get("noise")
    if isinstance(noise, Image):
        drawings.append(picture(engine.value(plan, f"{IT}.noise", work), "the noise alone"))
    return drawings


def picture(samples: Array, caption: str, limits: tuple[float, float] | None = None) -> str:
    """A picture in grey as a piece of a page."""
    low, high = limits or robust_limits(samples)
    if (step := -(-max(samples.shape) // _LARGEST)) > 1:
        samples = block_means(samples, step, step)
    levels = grey_levels(low, high, samples)
    times = max(1, _LARGE // max(levels.shape))
    levels = np.repeat(np.repeat(levels, times, axis=0), times, axis=1)
    rows, columns = levels.shape
    size = f'width="{columns}" height="{rows}" '
    return png_figure(encode_png(levels), caption, "picture", size)


def png_figure(content: bytes, caption: str, kind: str, size: str = "") -> str:
    data, text = base64.b64encode(content).decode(), html.escape(caption)
    return (
        f'<figure class="{kind}"><img alt="{text}" {size}src="data:image/png;base64,{data}">'
        f"<figcaption>{text}</figcaption></figure>"
    )


def _transfer(value: Transfer, samples: Array) -> str:
    """A transfer function across and along; nothing of a phase that is 0."""
    if np.iscomplexobj(samples):
        samples = np.abs(samples)
    rows, columns = samples.shape
    grid = value.grid
    xi = np.arange(columns // 2 + 1) * grid.frequency_interval_x
    eta = np.arange(rows // 2 + 1) * grid.frequency_interval_y
    across, along = samples[0, : len(xi)], samples[: len(eta), 0]
    title = value.part.upper()
    if value.part == "ptf":
        # Of the last frequency of an even size only the real part acts.
        xi, across, eta, along = xi[:-1], across[:-1], eta[:-1], along[:-1]
        if max(np.abs(across).max(), np.abs(along).max()) < _SMALLEST_PHASE:
            return ""
    alike = bool(np.abs(np.interp(xi, eta, along) - across).max() < _ALIKE)
    series = [Series("horizontal and vertical" if alike else "horizontal (ξ)", xi, across)]
    series += [] if alike else [Series("vertical (η)", eta, along)]
    unit = " (rad)" if value.part == "ptf" else ""
    return curves(CurveData(title, "cycles/mrad", title + unit, tuple(series)), title)


def curves(data: CurveData, caption: str) -> str:
    """Curves or bars as a piece of a page."""
    rows = -(-len(data.series) // 2) if len(data.series) > 1 else 0
    bars = 0.24 * len(data.bars) * len(data.series) + 0.8 if data.bars else 0.0
    with figure(_WIDE, max(_HIGH, bars) + 0.2 * rows) as (drawn, out):
        draw_on(drawn.subplots(), data)
        if len(data.series) > 1:
            drawn.legend(loc="outside lower center", ncols=2, fontsize=7.5)
    return png_figure(out.getvalue(), caption, "curve")


def _shown(value: Any) -> str:
    if isinstance(value, Sequence) and not isinstance(value, str):
        return ", ".join(_shown(one) for one in value)
    if isinstance(value, bool | str):
        return str(value)
    return number(float(value))


# The small network in which a module is shown: a few nodes before it, and its settings.

Nodes = Mapping[str, tuple[str, Mapping[str, Any]]]
IT = "it"
"""Name of the node that is shown."""
SHIPPED = Path(networks.__path__[0])

SCENE = {
    "width": 192, "height": 144, "fov_x_deg": 1.2, "fov_y_deg": 0.9,
    "cut_on_um": 3.7, "cut_off_um": 4.8,
}  # fmt: skip
SENSOR = {
    "detector_x_um": 30, "detector_y_um": 30, "focal_length_mm": 100, "f_number": 4,
    "range_m": 1000, "scan_velocity_mrad_per_s": 5000,
}  # fmt: skip
DAY = {"cut_on_um": 0.5, "cut_off_um": 0.7, "bands": 2, "sun_elevation_deg": 45}

# What stands before the module; only nodes that its links need are part of its network.
BEFORE: Nodes = {
    "scene": ("test_scene", SCENE),
    "init": ("init_trans", SENSOR),
    "pupil": ("exit_pupil", {"shape": "cassegrain", "size_x": 128, "size_y": 128,
                             "radius": 50, "obscuration_radius": 20}),
    "blur": ("gaussian_mtf", {"sigma_x_mrad": 0.1, "sigma_y_mrad": 0.1}),
    "detector": ("detector_mtf", {}),
    "back": ("back_transform", {}),
    "sensor": ("electronics_noise", {"region": "MWIR", "material": "InSb",
                                     "amplifier_snr": 150, "gain_percent": 1, "bits": 8}),
    "edge": ("test_scene", {**SCENE, "kind": "slanted_edge", "width": 96, "height": 96}),
    "kelvin": ("to_temperature", {}),
    "unlike": ("focal_plane", {"integration_time_s": 1e-3, "full_well_e": 4e6,
                               "prnu_percent": 3, "dsnu_e": 30000, "read_noise_e": 100,
                               "units": "radiance"}),
    "day": ("test_scene", {**SCENE, **DAY}),
    "ground": ("test_scene", {**SCENE, "kind": "airfield"}),
    "reflectance": ("read_image", {"path": "pictures/thumbnail_kodak_kir310.png",
                                   "unit": "%", "scale": 0.3, "fov_x_deg": 1.2,
                                   "fov_y_deg": 0.9, "cut_on_um": 0.5, "cut_off_um": 0.7}),
    "counted": ("focal_plane", {"integration_time_s": 2e-3, "full_well_e": 4e6,
                                "read_noise_e": 30}),
    "long": ("focal_plane", {"integration_time_s": 8e-3, "full_well_e": 6e6,
                             "read_noise_e": 500, "units": "electrons", "bits": 0}),
    "short": ("focal_plane", {"integration_time_s": 1e-3, "full_well_e": 6e6,
                              "read_noise_e": 500, "units": "electrons", "bits": 0}),
}  # fmt: skip
LINKS = (
    ("scene.image", "init.image"), ("init.context", "blur.context"),
    ("init.magnitude", "blur.magnitude"), ("init.context", "detector.context"),
    ("blur.magnitude", "detector.magnitude"), ("detector.magnitude", "back.magnitude"),
    ("init.phase", "back.phase"), ("back.image", "sensor.image"),
    ("init.context", "sensor.context"),
    ("scene.image", "kelvin.image"), ("scene.image", "unlike.image"),
    ("init.context", "unlike.context"), ("day.image", "counted.image"),
    ("init.context", "counted.context"),
    ("scene.image", "long.image"), ("init.context", "long.context"),
    ("scene.image", "short.image"), ("init.context", "short.context"),
)  # fmt: skip
SOURCES: Mapping[str, str] = {
    "image": "scene.image", "context": "init.context", "magnitude": "init.magnitude",
    "phase": "init.phase", "pupil": "pupil.pupil", "transfer": "detector.magnitude",
}  # fmt: skip
OWN_SOURCES: Mapping[tuple[str, str], str | None] = {
    ("measured_mtf", "image"): "edge.image",
    ("to_radiance", "image"): "kelvin.image",
    ("reflected_light", "image"): "reflectance.image",
    ("to_radiance", "emissivity"): None,
    ("to_temperature", "emissivity"): None,
    ("compare_images", "image"): "back.image",
    ("compare_images", "reference"): "scene.image",
    ("noise_budget", "image"): "sensor.image",
    ("noise_3d", "image"): "sensor.image",
    ("figures_of_merit", "image"): "sensor.image",
    ("image_quality", "image"): "counted.image",
    ("back_transform", "magnitude"): "detector.magnitude",
    ("sample_pixels", "image"): "back.image",
    ("nuc", "image"): "unlike.image",
    ("persistence", "earlier"): "ground.image",
    ("camera_geometry", "image"): "ground.image",
    ("dual_gain", "high"): "long.image",
    ("dual_gain", "low"): "short.image",
    ("dual_gain", "high_table"): "long.table",
    ("dual_gain", "low_table"): "short.table",
    ("spatial_blur", "magnitude"): "blur.magnitude",
    ("line_by_line", "magnitude"): "blur.magnitude",
    ("mtf_slices", "transfer"): "detector.magnitude",
}

PARAMS: Mapping[str, Mapping[str, Any]] = {
    "read_image": {"path": "cubes/scene.img"},
    "test_scene": SCENE,
    "init_trans": SENSOR,
    "combine_pixels": {"factor_x": 3, "factor_y": 3},
    "sample_pixels": {"factor_x": 3, "factor_y": 3},
    "anti_alias": {"factor": 4},
    "interpolate": {"width": 48, "height": 36},
    "atmospheric_path": {"model": "visibility_km", "visibility_km": 3, "air_K": 288},
    "atmosphere_mtf": {"turbulence": "long_exposure", "fried_r0_m": 0.02,
                       "turbidity": "high", "turbidity_cutoff_cyc_per_mrad": 1},
    "camera": {"pixels_x": 140, "pixels_y": 105, "pitch_um": 15, "focal_length_mm": 100,
               "f_number": 4, "range_m": 1000},
    "diffraction_mtf": {"obscuration_ratio": 0.3, "defocus_waves": 0.3},
    "exit_pupil": {"shape": "spider", "size_x": 128, "size_y": 128, "radius": 50,
                   "obscuration_radius": 18, "vanes": 4, "vane_width": 4,
                   "defocus_waves": 0.5},
    "exit_pupil_mtf": {"size_x_cm": 3.2, "size_y_cm": 3.2, "wavelengths": 3},
    "gaussian_mtf": {"sigma_x_mrad": 0.15, "sigma_y_mrad": 0.08},
    "mtf_file": {"path": "lenses/measured_lens_mtf.csv"},
    "psf_file": {"path": "lenses/measured_lens_psf.png", "sample_pitch": 8},
    "poisson_noise": {"mode": "photon", "photons_per_unit": 3000},
    "crosstrack_mtf": {"dwell_time_s": 1e-4},
    "alongtrack_mtf": {"velocity_m_per_s": 100, "integration_time_s": 5e-3},
    "relative_motion_mtf": {"platform_velocity_x": 100, "platform_velocity_y": 60,
                            "integration_time_s": 5e-3, "model": "line"},
    "jitter_mtf": {"sigma_mrad": 0.12},
    "vibration_mtf": {"amplitude_x_mrad": 0.2, "amplitude_y_mrad": 0.1},
    "line_of_sight": {"rms_x_mrad": 0.3, "rms_y_mrad": 0.15, "corner_Hz": 50,
                      "integration_time_s": 0.01},
    "vignetting": {"measured": "polynomial", "against": "half_diagonal",
                   "coefficients": [-0.4, -0.2]},
    "distortion": {"k1": -900, "width": 144, "height": 108},
    "field_psf": {"tangential_mrad": [0.05, 0.1, 0.4], "sagittal_mrad": [0.05, 0.07, 0.15],
                  "tile": 32},
    "veiling_glare": {"share_percent": 15, "length_mrad": 20},
    "microlens": {"chief_ray_deg": 35, "half_response_deg": 25},
    "read_window": {"columns": 96, "rows": 72, "row_time_us": 20},
    "dual_gain": {"switch_level": 5.5e6, "low_factor": 8},
    "crosstalk": {"kernel": "0.02 0.05 0.02; 0.05 0.72 0.05; 0.02 0.05 0.02"},
    "charge_diffusion_mtf": {"absorption_per_um": 0.02, "diffusion_length_um": 100},
    "charge_eff_mtf": {"efficiency": 0.9985},
    "charge_eff_phase": {"efficiency": 0.9985},
    "tdi_mtf": {"stages": 32, "phases": 4, "velocity_mismatch_percent": 3},
    "rolling_shutter": {"image_velocity_x": 8000, "image_velocity_y": -2000},
    "frame_transfer_smear": {"line_transfer_time_s": 2e-5},
    "blooming": {"full_well": 1.7},
    "charge_trails": {"serial_efficiency": 0.99, "parallel_efficiency": 0.99},
    "persistence": {"fast_percent": 20, "delay_s": 0.5},
    "spectral_response": {"shape": "gaussian", "peak": 0.8},
    "focal_plane": {"integration_time_s": 1e-3, "full_well_e": 4e6, "read_noise_e": 2000,
                    "prnu_percent": 1, "dsnu_e": 8000, "bad_pixel_percent": 0.2, "bits": 12},
    "microbolometer": {"netd_mK": 900, "response_percent": 2, "offset_mK": 900},
    "electronics_noise": {"region": "MWIR", "material": "InSb", "amplifier_snr": 60,
                          "gain_percent": 2, "bias_percent": 1, "use_mtf": True, "bits": 6},
    "periodic_noise": {"amplitude": 0.15, "xi": 0.7, "eta": 0.2},
    "noise_3d_source": {"sigma_tvh": 0.03, "sigma_h": 0.05, "sigma_v": 0.03},
    "measured_mtf": {"region_width": 80},
    "figures_of_merit": {"frame_rate_Hz": 25},
    "image_quality": {"range_m": 5000},
    "noise_3d": {"frames": 4},
    "noise_budget": {"frequency": 1.0},
    "line_by_line": {"look_angle_deg": 30},
    "spatial_blur": {},
    "camera_geometry": {"ground_interval_m": 6, "fov_x_deg": 50, "columns": 160, "rows": 120},
}  # fmt: skip
NO_EXAMPLE: Mapping[str, str] = {
    "write_image": "This module writes a file, so it has no picture to show.",
    "write_matrix": "This module writes a file, so it has no picture to show.",
    "noise_file": "This module needs a noise file of your own, which must have the same size "
    "as the picture.",
}


def example_network(declared: Declaration, library: Library) -> Network:
    """The network with the module as its node `it`, and with what its links need."""
    nodes = {**BEFORE, IT: (declared.key, PARAMS.get(declared.key, {}))}
    links = list(LINKS)
    for port in declared.inputs:
        source = OWN_SOURCES.get((declared.key, port.name), SOURCES.get(port.types[0]))
        if source is not None:
            links.append((source, f"{IT}.{port.name}"))
    if declared.output("magnitude") or declared.output("phase"):
        nodes["seen"] = ("back_transform", {})
        for name in ("magnitude", "phase"):
            made = declared.output(name) is not None and declared.key != "init_trans"
            links.append((f"{IT if made else 'init'}.{name}", f"seen.{name}"))
    sources: dict[str, list[str]] = {}
    for source, target in links:
        sources.setdefault(_node(target), []).append(_node(source))
    needed = reached(sources, {IT, "seen"} & nodes.keys())
    shown: dict[str, Node] = {}
    for name, (key, params) in nodes.items():
        own = declaration(library[key]).parameter
        if name in needed:
            shown[name] = Node(name, key, {k: v for k, v in params.items() if own(k)})
    wires = tuple(Link.between(*link) for link in links if _node(link[1]) in needed)
    return Network(name=declared.title, seed=1996, nodes=shown, links=wires)


def _node(port: str) -> str:
    return port.partition(".")[0]


# What the handbook holds, in its order.

PAGES = Path(__file__).with_name("pages")


PARTS = {
    title: tuple(pages.split())
    for title, pages in {
        "Begin": "index getting_started",
        "Tutorials": "infrared_camera edge_pictures real_camera fitting laboratory satellite "
        "dirsig_scene lens_and_mtf cluster_study",
        "Guides": "editor editor_views commands network_files python_package cameras judging "
        "studies beyond_memory plug_ins",
        "Reference": "reference glossary shipped_networks published_cameras formulas "
        "speed_and_accuracy how_it_works extending",
    }.items()
}
"""Names of the pages' files by the titles under which they stand."""
REFERENCE = "reference"
"""The page that lists the modules."""
MODULES = "modules"
"""Folder of the modules' pages."""


# Published cameras: the read-outs of their networks beside the figures of data sheets and papers.
#
# A network of `networks/published` has `published` as every network may (`published_facts`), and
# `inputs`: a list of objects with `of`, names of parameters, and `where`, the source of their
# values. A value that no source gives has `until` NODE.READOUT=VALUE, the figure it was solved
# from, and `reason`: whether it is plausible. `where` then says solved.

_NO_SOURCE = ("any value", "assumed", "solved")


def published_camera(name: str, engine: Engine) -> dict[str, Any]:
    """What its page has: figures beside ours, where values come from, and what is cited."""
    path = published_networks()[name]
    network = load_network(path, library=engine.library)
    plan, work = engine.plan(network, folder=path.parent), engine.work(Policy())
    facts = thaw(network.extra)
    inputs = [
        {
            **{"until": "", "reason": "", "published": not entry["where"].startswith(_NO_SOURCE)},
            **entry,
            "pairs": [(port, _value(plan, port)) for port in entry["of"]],
        }
        for entry in facts["inputs"]
    ]
    # In the order of the inputs, then of the figures.
    sources: dict[str, list[tuple[str, str]]] = {}
    for entry in inputs:
        if entry["published"]:
            sources.setdefault(entry["where"], []).extend(entry["pairs"])
    figures = []
    for entry in facts["published"]:
        node, _, readout = entry["from"].partition(".")
        ours = float(engine.readouts(plan, node, work)[readout])
        sources.setdefault(entry["where"], [])
        source = [*sources].index(entry["where"]) + 1
        figures.append(entry | _beside(entry, ours) | {"ours": ours, "source": source})
    largest = max(figures, key=lambda figure: abs(figure["percent"]))
    about = {"name": name, "title": network.name, "text": network.description}
    return about | {"figures": figures, "largest": largest, "inputs": inputs, "sources": sources}


def _beside(entry: Mapping[str, Any], ours: float) -> dict[str, Any]:
    """How much more ours is than a published figure, and both as they are printed."""
    value, unit = entry["value"], entry["unit"]
    percent = 100.0 * (ours - value) / value
    digits = len(f"{value:g}".replace(".", "").lstrip("0"))  # ours has four, or as many
    return {
        "percent": percent,
        "difference": f"{round(percent, 1) + 0.0:+.1f} %".replace("-", "−"),
        "accepted": f"± {short(100.0 * entry['within'] / value, 2)} %",
        "published": f"{number(value)} {unit}".strip(),
        "computed": f"{short(ours, max(4, digits))} {unit}".strip(),
    }


def _value(plan: Plan, port: str) -> str:
    node, _, name = port.partition(".")
    planned = plan.nodes[node]
    parameter = next(each for each in planned.declaration.parameters if each.name == name)
    return f"{number(getattr(planned.module, name))} {parameter.param.unit}".strip()
