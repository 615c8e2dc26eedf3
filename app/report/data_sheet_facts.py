"""A camera's data sheet: its figures in the order in which makers give them, as plain data."""

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from app.run.evaluation import Evaluation
from app.run.shipped import every_network
from app.run.transfer_chain import Axis, mtf_at, response
from core.chain.engine import Plan, realize
from core.chain.wires import Image
from core.errors import NetworkError, close
from core.modules.parameters import plain
from core.network.file import read_network
from core.network.network import Network
from core.network.validation import plain_network
from core.physics.acquisition.giqe import relative_edge_response
from nodes.detector.focal_plane_figures import SNR_AT_PERCENT

Fact = dict[str, Any]
Rows = Sequence[tuple[str, str, str]]
BAND = "band_um"
EXTINCTION = "extinction_per_km"

_CAMERA: Rows = (  # label, figure, of both axes where it ends in *; in the order of a data sheet
    ("Pixels", "pixels_*", ""),
    ("Pixel pitch", "pitch_*_um", "µm"),
    ("Fill factor", "fill_*", ""),
    ("Focal length", "focal_length_mm", "mm"),
    ("F-number", "f_number", ""),
    ("Aperture", "aperture_mm", "mm"),
    ("Obscuration", "obscuration_ratio", ""),
    ("Field of view", "fov_*_deg", "deg"),
    ("IFOV (angle of a pixel)", "pixel_*_mrad", "mrad"),
    ("Nyquist frequency", "nyquist_*", "cyc/mrad"),
    ("Q (λ·F/pitch)", "q", ""),
    ("Range", "range_m", "m"),
    ("Ground sample distance", "gsd_*_m", "m"),
    ("Altitude", "altitude_km", "km"),
    ("Elevation of the line of sight at the target", "elevation_deg", "deg"),
    ("Ground sample distance, projected onto the ground", "gsd_ground_*_m", "m"),
    ("Ground speed", "ground_speed_m_per_s", "m/s"),
    ("Line rate for one pixel per line", "line_rate_Hz", "Hz"),
)
TIMES, UP_TO = " × ", " to "  # between the values of both axes, and of both ends
_FOCAL_PLANE: Rows = (
    ("Spectral band", BAND, "µm"),
    ("Integration time", "integration_time_s", "s"),
    ("TDI stages", "tdi_stages", ""),
    ("Frames averaged", "frames_averaged", ""),
    ("Quantum efficiency", "quantum_efficiency", ""),
    ("Quantum efficiency from", "response", ""),
    ("Transmission of the optics", "optics_transmission", ""),
    ("Read noise", "read_noise_e", "e-"),
    ("PRNU", "prnu_percent", "%"),
    ("DSNU", "dsnu_e", "e-"),
    ("Full well", "full_well_e", "e-"),
    ("Bits", "bits", ""),
    ("Gain", "gain_e_per_dn", "e-/DN"),
    ("Signal electrons from the scene", "signal_e", "e-"),
    ("Electrons from the optics", "optics_e", "e-"),
    ("Electrons from the housing", "housing_e", "e-"),
    ("Dark electrons", "dark_e", "e-"),
    ("Well fill", "well_fill_percent", "%"),
    ("Dynamic range", "dynamic_range_dB", "dB"),
    ("Dynamic range (EMVA 1288)", "emva_dynamic_range_dB", "dB"),
    ("SNR", "snr", ""),
    ("Maximum SNR (at saturation, shot noise only)", "snr_max", ""),
    ("Maximum SNR (at saturation, shot noise only)", "snr_max_dB", "dB"),
    ("Absolute sensitivity threshold", "sensitivity_threshold_photons", "photons"),
    ("Radiance at saturation", "saturation_radiance", "W/m²/sr"),
    *((f"SNR at {p} % of saturation", f"snr_at_{p}_percent", "") for p in SNR_AT_PERCENT),
    ("Reference radiance", "reference_radiance", "W/m²/sr/µm"),
    ("SNR at the reference radiance", "snr_at_reference", ""),
    ("NETD", "netd_K", "K"),
    ("NEI", "nei_photons_per_cm2", "photons/cm²"),
)
_MICROBOLOMETER: Rows = (
    ("Spectral band", BAND, "µm"),
    ("NETD in the data sheet", "netd_mK", "mK"),
    ("F-number for this NETD", "reference_f_number", ""),
    ("Transmission of the optics", "optics_transmission", ""),
    ("Thermal time constant", "time_constant_s", "s"),
    ("Frame rate", "frame_rate_Hz", "Hz"),
    ("NETD", "netd_K", "K"),
    ("White noise", "white_netd_K", "K"),
    ("1/f noise", "flicker_K", "K"),
    ("Fixed pattern", "fixed_pattern_K", "K"),
    ("Lag (change remaining after one frame)", "lag_percent", "%"),
    ("SNR", "snr", ""),
)
_LIGHT: Rows = (
    ("Ground illuminance", "illuminance", "lx"),
    ("Ground irradiance in the band", "irradiance", "W/m²"),
)
_AIR: Rows = (("Transmission", "transmission", ""), ("Optical depth", "optical_depth", ""))
_RANGES: Rows = (
    ("Target size", "target_size_m", "m"),
    ("Target minus background", "target_delta_K", "K"),
    ("Atmospheric extinction", EXTINCTION, "1/km"),
    ("NETD of the chain", "netd_K", "K"),
    ("Detection (Johnson)", "detection_range_km", "km"),
    ("Recognition (Johnson)", "recognition_range_km", "km"),
    ("Identification (Johnson)", "identification_range_km", "km"),
    ("TTP range", "ttp_range_km", "km"),
)
_QUALITY: Rows = (
    ("Ground sample distance", "gsd_m", "m"),
    ("Relative edge response", "rer", ""),
    ("Overshoot H", "overshoot", ""),
    ("SNR", "snr", ""),
    ("NIIRS by GIQE 5", "giqe5", "NIIRS"),
    ("NIIRS by GIQE 4", "giqe4", "NIIRS"),
)
_GROUPS: Mapping[str, tuple[str, Rows]] = {
    "camera": ("Camera", _CAMERA),
    "focal_plane": ("Focal plane", _FOCAL_PLANE),
    "microbolometer": ("Microbolometer", _MICROBOLOMETER),
    "reflected_light": ("Light", _LIGHT),
    "atmospheric_path": ("Air", _AIR),
    "figures_of_merit": ("Range", _RANGES),
    "image_quality": ("Image quality", _QUALITY),
}
_CAMERAS = ("camera", "focal_plane", "microbolometer")  # without one there is no data sheet
_NOISES = (
    ("Shot noise", "shot_noise_e"),
    ("Excess noise of the charge gain", "excess_noise_e"),
    ("Read noise", "read_noise_e"),
    ("Quantization", "quantization_noise_e"),
    ("All temporal noise", "temporal_noise_e"),
    ("Fixed pattern", "fixed_pattern_e"),
)


def data_sheet_facts(evaluation: Evaluation, nodes: Fact) -> Fact | None:
    """The figures by module, noise by source, and the MTF at the pixels' Nyquist frequency."""
    working = {name: node for name, node in nodes.items() if not node["disabled"]}
    if not any(node["module"] in _CAMERAS for node in working.values()):
        return None
    groups = []
    for module, (title, wanted) in _GROUPS.items():
        for name, node in working.items():
            if node["module"] == module:
                figures = {**_figures(node), BAND: _band(evaluation, name, node)}
                if module == "focal_plane" and figures["response"]:
                    figures["quantum_efficiency"] = None  # the file takes its place
                inputs = evaluation.plan.nodes[name].inputs.values()
                if any(value.air for value in inputs if isinstance(value, Image)):
                    figures[EXTINCTION] = None  # the ranges take the transmission of the path
                rows = list(_rows(figures, wanted))
                groups.append({"title": title, "node": name, "rows": rows})
    noises = [
        {"node": name, "rows": list(_noise_rows(_figures(node)))}
        for name, node in working.items()
        if node["module"] == "focal_plane"
    ]
    return {"groups": groups, "noises": noises, "mtf": _at_pixel_nyquist(evaluation)}


def _figures(node: Fact) -> dict[str, Any]:
    """Parameters, tables and read-outs by name; of one name the read-out counts."""
    return {
        **{name: given["value"] for name, given in node["parameters"].items()},
        **{row["name"]: row["value"] for table in node["tables"].values() for row in table},
        **{name: shown["value"] for name, shown in node["readouts"].items()},
    }


def _rows(figures: Mapping[str, Any], wanted: Rows) -> Iterator[Fact]:
    """What there is of the figures; those along both axes in one row."""
    for label, name, unit in wanted:
        if name == BAND:
            if figures[BAND] is not None:
                ends = list(figures[BAND])
                yield {"label": label, "values": ends, "unit": unit, "between": UP_TO}
            continue
        places = [name.replace("*", axis) for axis in "xy"] if "*" in name else [name]
        values = [figures.get(place) for place in places]
        if all(value is not None for value in values):
            yield {"label": label, "values": values, "unit": unit, "between": TIMES}


def _band(evaluation: Evaluation, name: str, node: Fact) -> tuple[float, float] | None:
    """The wavelengths that a detector counts: its filter's, else its picture's."""
    own = [node["parameters"].get(end, {}).get("value") for end in ("cut_on_um", "cut_off_um")]
    inputs = evaluation.plan.nodes[name].inputs.values()
    known = next((band for value in inputs if (band := getattr(value, "band_um", None))), None)
    low, high = (
        end if end is not None else known and known[place] for place, end in enumerate(own)
    )
    return None if low is None or high is None else (low, high)


def _noise_rows(figures: Mapping[str, Any]) -> Iterator[Fact]:
    """Noises in electrons, and in kelvin where the scene is warm."""
    per_kelvin = figures.get("responsivity_e_per_K")
    for label, name in _NOISES:
        noise = figures[name]
        if name == "excess_noise_e" and not noise:
            continue
        yield {"label": label, "e-": noise, "K": noise / per_kelvin if per_kelvin else None}


def _at_pixel_nyquist(evaluation: Evaluation) -> Fact | None:
    """The MTF of every stage at the Nyquist frequency of the picture that is delivered."""
    chain, work = evaluation.chain, evaluation.work
    final = evaluation.plan.output(chain.final) if chain.final else None
    if not isinstance(final, Image) or not final.interval_x_mrad or not final.interval_y_mrad:
        return None
    if not chain.stages or not chain.cascade:
        return None
    axes: tuple[Axis, Axis] = ("x", "y")
    intervals = final.interval_x_mrad, final.interval_y_mrad
    nyquist = {axis: 0.5 / each for axis, each in zip(axes, intervals, strict=True)}
    rows: list[Fact] = []
    product: Fact = {"x": 1.0, "y": 1.0}
    for stage in (*chain.stages, *chain.later):
        mtf: Fact = {axis: mtf_at(work, stage.factors, nyquist[axis], axis) for axis in axes}
        product = {axis: product[axis] * mtf[axis] for axis in axes}
        rows.append({"label": stage.title, "node": stage.node, **mtf})
    rows.append({"label": "All together", "node": "", **product})
    edges = {
        f"edge_{axis}": relative_edge_response(
            mtf=lambda at, axis=axis: response(work, chain.factors, at, axis).mtf,  # type: ignore[misc]
            sample_mrad=0.5 / nyquist[axis],
        )
        for axis in axes
    }
    return {"nyquist_x": nyquist["x"], "nyquist_y": nyquist["y"], "rows": rows, **edges}


# Published figures, beside those of this run.
#
# A network may carry two fields for it. `published` is a list of objects with `figure`, `where`,
# `value`, `unit`, `from`, `within` and `reason`: `from` names the figure of this run, which is
# reproduced where it differs by no more than `within`. It is NODE.READOUT, or NODE.PORT.mean
# (sigma, minimum, maximum) of a picture, or NODE.mtf_nyquist_x (ptf, y; `total` for the product).
# `conflicts` is a list of texts: where the source contradicts itself.
#
# The figures of a shipped network belong to its own modules, wires, values and scene. A changed
# network that still carries them is not compared.

REPRODUCED, DIFFERENT, ABSENT = "reproduced", "not reproduced", "not computed"
_STATISTICS: Mapping[str, Any] = {
    "mean": lambda samples: np.mean(samples, dtype=np.float64),
    "sigma": lambda samples: np.std(samples, dtype=np.float64),
    "minimum": np.min,
    "maximum": np.max,
}
_TEXTS = ("figure", "where", "unit", "from", "reason")
_FIELDS = (*_TEXTS, "value", "within")


def published_facts(evaluation: Evaluation, nyquist: Mapping[str, float]) -> Fact:
    """Each published figure with ours and a verdict, and conflicts within the source.

    Nothing of a shipped network that was changed.
    """
    entries = evaluation.network.extra.get("published", ())
    if not isinstance(entries, tuple):
        raise NetworkError("published must be a list of figures")
    if _is_changed(evaluation):
        return {"published": [], "conflicts": []}
    rows = [_row(evaluation, nyquist, number, entry) for number, entry in enumerate(entries, 1)]
    return {"published": rows, "conflicts": _conflicts(evaluation.network)}


def _is_changed(evaluation: Evaluation) -> bool:
    """Whether the figures were published for a shipped network, and this one differs from it."""
    wanted = _named(evaluation.network.extra.get("published", ()))
    changed = False
    for path in every_network().values() if wanted else ():
        text = path.read_text(encoding="utf-8")
        if '"published":' in text and _named(json.loads(text).get("published", ())) == wanted:
            library = evaluation.engine.library
            network = plain_network(read_network(path, library=library), library=library)
            shipped = evaluation.engine.plan(network, folder=path.parent)
            if _content(shipped) == _content(evaluation.plan):
                return False
            changed = True
    return changed


def _named(entries: Any) -> list[Any]:
    rows = [entry for entry in entries if isinstance(entry, Mapping)]
    return [[entry.get(name) for name in ("figure", "where", "value")] for entry in rows]


def _content(plan: Plan) -> Any:
    nodes = {}
    for name, node in plan.nodes.items():
        values = [plain(getattr(node.module, each.name)) for each in node.declaration.parameters]
        nodes[name] = node.node.module, node.node.disabled, values
    return nodes, set(plan.network.links)


def _conflicts(network: Network) -> list[str]:
    texts = network.extra.get("conflicts", ())
    if not isinstance(texts, tuple) or not all(isinstance(text, str) for text in texts):
        raise NetworkError("conflicts must be a list of strings")
    return list(texts)


def _row(
    evaluation: Evaluation, nyquist: Mapping[str, float], number: int, entry: Any
) -> dict[str, Any]:
    where = f"published figure {number}"
    if not isinstance(entry, Mapping) or "figure" not in entry or "value" not in entry:
        raise NetworkError(f"{where} must be an object with the fields figure and value")
    for name, value in entry.items():
        if name not in _FIELDS:
            raise NetworkError(f"{where} has an unknown field {name!r:.80}{close(name, _FIELDS)}")
        if name in _TEXTS and not isinstance(value, str):
            raise NetworkError(f"{where}: {name} must be a string")
    row: dict[str, Any] = {name: entry.get(name, "") for name in _TEXTS}
    row |= {"value": entry["value"], "within": entry.get("within"), "ours": None}
    if not row["from"]:
        return row | {"verdict": ABSENT}
    if not _is_number(row["value"]) or not _is_number(row["within"]) or row["within"] < 0:
        raise NetworkError(
            f'{where} ({row["figure"]}): "value" must be a number, and "within" must be a '
            "number of at least 0"
        )
    ours = _figure(evaluation, nyquist, row["from"], where)
    if not _is_number(ours):
        return row | {"verdict": ABSENT}
    # The limits are decimal: without the allowance, 0.003 ± 0.0005 would not hold 0.0035.
    limit = row["within"] + 1e-12 * abs(row["value"])
    verdict = REPRODUCED if abs(ours - row["value"]) <= limit else DIFFERENT
    return row | {"ours": ours, "verdict": verdict}


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float | np.number) and not isinstance(value, bool)


def _figure(evaluation: Evaluation, nyquist: Mapping[str, float], name: str, where: str) -> Any:
    parts = name.split(".")
    if name in nyquist:
        return nyquist[name]
    if len(parts) == 2 and parts[1] in evaluation.readouts.get(parts[0], {}):
        return evaluation.readouts[parts[0]][parts[1]]
    if len(parts) == 3 and parts[2] in _STATISTICS and parts[0] in evaluation.plan.nodes:
        image = evaluation.plan.nodes[parts[0]].outputs.get(parts[1])
        if isinstance(image, Image):
            return float(_STATISTICS[parts[2]](realize(image, evaluation.work)))
    known = [f"{node}.{name}" for node, own in evaluation.readouts.items() for name in own]
    raise NetworkError(f"{where}: no figure is called {name!r:.80}{close(name, known)}")
