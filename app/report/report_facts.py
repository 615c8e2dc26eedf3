"""All figures of a report as plain data."""

from __future__ import annotations

import sys
import time
from dataclasses import asdict
from typing import Any

import numpy as np

from app.options.command_options import version
from app.report.data_sheet_facts import conflicts, data_sheet_facts, is_changed, published_rows
from app.report.drawing.node_curves import curve_facts
from app.report.drawing.picture_drawing import drawn_as
from app.report.edge_measurement import judged_facts, response_over_band
from app.report.noise_and_blur_budget import NoiseBudget, blur_budget, noise_budget
from app.run.evaluation import Evaluation
from app.run.figures import main_figures
from app.run.output import ending_images
from app.run.responses import StageResponse, at_nyquist
from core.chain.back_transformed import Delivered
from core.chain.band_stack import BandStack
from core.chain.engine import PlannedNode
from core.chain.realize import realize
from core.chain.skipped import Skip, is_neutral
from core.chain.wires import Image, Table
from core.modules.parameters import plain
from core.names import thaw
from core.transfer.periodic import backend
from nodes.analysis.budget_shares import BlurShares, NoiseShare
from nodes.input_output.sample_unit import statistics

NOISE_PORTS = ("noise", "detector_noise", "quantization_error")


def report_facts(evaluation: Evaluation, skipped: tuple[Skip, ...]) -> dict[str, Any]:
    """The contents of a report, without its pictures."""
    network, chain = evaluation.network, evaluation.chain
    nyquist = at_nyquist(chain, evaluation.work)
    nodes = {name: _node(evaluation, name, node) for name, node in evaluation.plan.nodes.items()}
    return {
        "format": "imagechain-report",
        "version": 1,
        "network": {
            "name": network.name,
            "description": network.description,
            "nodes": len(network.nodes),
            "links": [link.text() for link in network.links],
        },
        "run": _run(evaluation),
        "warnings": [asdict(caution) for caution in evaluation.cautions],
        "pictures": [
            *(picture_facts(evaluation, port, "input") for port in chain.sources),
            *([picture_facts(evaluation, chain.final, "output")] if chain.final else []),
            *(
                picture_facts(evaluation, port, "other output")
                for port in ending_images(evaluation.plan)
                if port not in (chain.final, *chain.sources)
            ),
        ],
        "noise": [picture_facts(evaluation, port, "noise") for port in noise_ports(evaluation)],
        "transfer": {
            "xi_cyc_per_mrad": evaluation.responses.xi,
            "eta_cyc_per_mrad": evaluation.responses.eta,
            "stages": [_stage(stage) for stage in evaluation.responses.stages],
            "beside": [_stage(stage) for stage in evaluation.responses.beside],
            "products": [_stage(stage) for stage in evaluation.responses.products],
            "at_nyquist": nyquist,
        },
        "judged": judged_facts(evaluation),
        "drawn_as": drawn_as(network),
        "curves": curve_facts(evaluation),
        "budget": budget_facts(evaluation),
        "spectra": spectrum_facts(evaluation),
        "figures": [asdict(figure) for figure in main_figures(evaluation)],
        "data_sheet": data_sheet_facts(evaluation, nodes),
        "nodes": nodes,
        "published": published_rows(evaluation, nyquist),
        "conflicts": [] if is_changed(evaluation) else conflicts(network),
        "skipped": _skipped(skipped),
    }


def noise_ports(evaluation: Evaluation) -> list[str]:
    """Ports of noise pictures, in the network's order."""
    return [
        f"{name}.{port}"
        for name, node in evaluation.plan.nodes.items()
        for port in NOISE_PORTS
        if isinstance(node.outputs.get(port), Image) and not node.node.disabled
    ]


def picture_facts(evaluation: Evaluation, port: str, role: str) -> dict[str, Any]:
    """Size, sampling and statistics of a picture; σ is of all its samples."""
    image: Image = evaluation.plan.output(port)
    seen = statistics(realize(image, evaluation.work), for_each=evaluation.work.for_each)
    return {
        "port": port,
        "role": role,
        "columns": image.columns,
        "rows": image.rows,
        "interval_x_mrad": image.interval_x_mrad,
        "interval_y_mrad": image.interval_y_mrad,
        "unit": image.unit,
        "band_um": image.band_um,
        "minimum": seen.minimum,
        "maximum": seen.maximum,
        "mean": seen.mean,
        "sigma": seen.sigma,
    }


def _run(evaluation: Evaluation) -> dict[str, Any]:
    import scipy

    policy = evaluation.work.policy
    return {
        "date": time.strftime("%Y-%m-%d %H:%M %z"),
        "precision": policy.precision,
        "threads": policy.workers,
        "tolerance": policy.budget,
        "seed": evaluation.network.seed,
        "seconds": dict(evaluation.seconds),
        "versions": {
            "imagechain": version(),
            "python": ".".join(map(str, sys.version_info[:3])),
            "numpy": np.__version__,
            "scipy": scipy.__version__,
        },
        "transforms": backend(),
        "way": dict(evaluation.way),
    }


def _stage(stage: StageResponse) -> dict[str, Any]:
    return {
        "name": stage.name,
        "title": stage.title,
        "mtf_x": stage.x.mtf,
        "ptf_x_rad": stage.x.ptf,
        "mtf_y": stage.y.mtf,
        "ptf_y_rad": stage.y.ptf,
    }


def _skipped(skipped: tuple[Skip, ...]) -> dict[str, list[dict[str, Any]]]:
    nodes: dict[str, list[dict[str, Any]]] = {}
    for skip in skipped:
        said = asdict(skip)
        nodes.setdefault(said.pop("node"), []).append(said)
    return nodes


def _node(evaluation: Evaluation, name: str, node: PlannedNode) -> dict[str, Any]:
    declared = node.declaration
    values = evaluation.readouts.get(name, {})
    assert node.module is not None
    return {
        "module": declared.key,
        "title": declared.title,
        "group": declared.group,
        "summary": declared.summary,
        "disabled": node.node.disabled,
        "neutral": is_neutral(node),
        "seconds": evaluation.work.seconds.get(name, 0.0),
        "set": sorted(thaw(node.node.params)),
        "parameters": {
            parameter.name: {
                "value": plain(getattr(node.module, parameter.name)),
                "unit": parameter.param.unit,
            }
            for parameter in declared.parameters
        },
        "readouts": {
            readout.name: {
                "value": values[readout.name],
                "unit": node.unit(readout),
                "meaning": readout.meaning,
            }
            for readout in declared.readouts
            if readout.name in values
        },
        "tables": {
            port: [
                {"name": r.name, "value": r.value, "unit": r.unit, "meaning": r.meaning}
                for r in realize(value, evaluation.work).rows
            ]
            for port, value in node.outputs.items()
            if isinstance(value, Table)
        },
    }


# The budget of noise and blur as plain data.

Fact = dict[str, Any]


def budget_facts(evaluation: Evaluation) -> Fact:
    """Noise and blur by stage; of what there is none, the reason."""
    noise, blur = noise_budget(evaluation), blur_budget(evaluation)
    return {
        "noise_reason": noise if isinstance(noise, str) else None,
        "noise": None if isinstance(noise, str) else _noise(evaluation, noise),
        "blur_reason": blur if isinstance(blur, str) else None,
        "blur": None if isinstance(blur, str) else _blur(blur),
    }


def _noise(evaluation: Evaluation, noise: NoiseBudget) -> Fact:
    predicted, measured = noise.predicted, noise.measured
    return {
        "port": noise.port,
        "unit": noise.unit,
        "summed": predicted.sigma,
        "temporal": predicted.temporal,
        "fixed": predicted.fixed,
        "together": None if isinstance(measured, str) else measured.sigma,
        "together_mean": None if isinstance(measured, str) else measured.mean,
        "together_reason": measured if isinstance(measured, str) else None,
        "sources": [_source(evaluation, share) for share in predicted.shares],
    }


def _source(evaluation: Evaluation, share: NoiseShare) -> Fact:
    planned = evaluation.plan.nodes.get(share.node)
    return {
        "node": share.node,
        "title": planned.declaration.title if planned else share.node,
        "name": share.name,
        "temporal": share.temporal,
        "fixed": share.fixed,
        "sigma": share.sigma,
        "share_temporal": share.share_temporal,
        "share_fixed": share.share_fixed,
        "share": share.share_temporal + share.share_fixed,
    }


def _blur(blur: BlurShares) -> Fact:
    return {
        "xi_cyc_per_mrad": blur.frequency[0],
        "eta_cyc_per_mrad": blur.frequency[1],
        "behind": blur.before,
        "mtf_x": blur.mtf[0],
        "mtf_y": blur.mtf[1],
        "stages": [
            {
                "node": share.node,
                "title": share.label,
                "mtf_x": share.mtf[0],
                "share_x": share.share[0],
                "mtf_y": share.mtf[1],
                "share_y": share.share[1],
            }
            for share in blur.shares
        ],
    }


# Pictures with bands of wavelength: their mean spectra, and the responses that weight them.


def spectrum_facts(evaluation: Evaluation) -> Fact:
    """Mean spectra, responses, and what stands for all wavelengths; empty lists without bands."""
    spectra: dict[str, Fact] = {}
    for port, image in _with_bands(evaluation):
        assert image.bands is not None
        means = image.bands.means()
        if means.key not in spectra:
            values = evaluation.work.value(means)
            spectra[means.key] = _spectrum(image.bands, values, image.unit)
        spectra[means.key]["ports"].append(port)
    return {
        "means": list(spectra.values()),
        "responses": _responses(evaluation) if spectra else [],
        "transformed": _transformed(evaluation),
    }


def _with_bands(evaluation: Evaluation) -> list[tuple[str, Image]]:
    return [
        (f"{name}.{port}", value)
        for name, planned in evaluation.plan.nodes.items()
        for port, value in planned.outputs.items()
        if not planned.node.disabled and isinstance(value, Image) and value.bands is not None
    ]


def _transformed(evaluation: Evaluation) -> list[Fact]:
    """Of filtered pictures: how many wavelengths stand for all bands, and what that changes."""
    transformed: dict[Any, Fact] = {}
    for port, image in _with_bands(evaluation):
        rank = image.recipe.rank(evaluation.work) if isinstance(image.recipe, Delivered) else None
        if rank is None:
            continue
        alike = tuple(rank.chosen), rank.bound
        fact = {"ports": [], "wavelengths": len(rank.chosen), "bands": rank.shares.shape[1]}
        transformed.setdefault(alike, {**fact, "bound": rank.bound})["ports"].append(port)
    return list(transformed.values())


def _spectrum(bands: BandStack, means: Any, unit: str) -> Fact:
    return {
        "ports": [],
        "bands": bands.count,
        "band_um": bands.band_um,
        "centres_um": list(bands.centres_um),
        "widths_um": list(bands.widths_um),
        "mean": [float(value) for value in means],
        "unit": f"{unit}/µm" if bands.density else unit,
    }


def _responses(evaluation: Evaluation) -> list[Fact]:
    """Of nodes into which a picture with bands comes."""
    responses = []
    for name, planned in evaluation.plan.nodes.items():
        image = planned.inputs.get("image")
        if not isinstance(image, Image) or image.bands is None:
            continue
        drawn = response_over_band(planned, evaluation.plan.folder)
        if drawn is not None:
            responses.append(
                {
                    "node": name,
                    "title": planned.declaration.title,
                    "name": drawn.name,
                    "wavelength_um": drawn.wavelength_um,
                    "values": drawn.values,
                }
            )
    return responses
