"""All figures of a report as plain data."""

from __future__ import annotations

import sys
import time
from dataclasses import asdict
from typing import Any

import numpy as np

from app.options.command_options import version
from app.report.drawing.drawn_as import drawn_as
from app.report.drawing.node_curves import curve_facts
from app.report.facts.budget_facts import budget_facts
from app.report.facts.edge_facts import judged_facts
from app.report.facts.published import conflicts, published_rows
from app.run.evaluation import Evaluation
from app.run.output import ending_images
from app.run.responses import StageResponse, at_nyquist
from core.chain.engine import PlannedNode
from core.chain.realize import realize
from core.chain.skipped import Skip, is_neutral
from core.chain.wires import Image, Table
from core.filtering.fft_backend import backend
from core.modules.parameters import plain
from core.names import thaw

NOISE_PORTS = ("noise", "detector_noise", "quantization_error")


def report_facts(found: Evaluation, skipped: tuple[Skip, ...]) -> dict[str, Any]:
    """What a report says, without its pictures."""
    network, chain = found.network, found.chain
    nyquist = at_nyquist(chain, found.work)
    return {
        "format": "imagechain-report",
        "version": 1,
        "network": {
            "name": network.name,
            "description": network.description,
            "nodes": len(network.nodes),
            "links": [link.text() for link in network.links],
        },
        "run": _run(found),
        "warnings": [asdict(each) for each in found.cautions],
        "pictures": [
            *(picture_facts(found, port, "input") for port in chain.sources),
            *([picture_facts(found, chain.final, "output")] if chain.final else []),
            *(
                picture_facts(found, port, "other output")
                for port in ending_images(found.plan)
                if port not in (chain.final, *chain.sources)
            ),
        ],
        "noise": [picture_facts(found, port, "noise") for port in noise_ports(found)],
        "transfer": {
            "xi_cyc_per_mrad": found.responses.xi,
            "eta_cyc_per_mrad": found.responses.eta,
            "stages": [_stage(stage) for stage in found.responses.stages],
            "beside": [_stage(stage) for stage in found.responses.beside],
            "products": [_stage(stage) for stage in found.responses.products],
            "at_nyquist": nyquist,
        },
        "judged": judged_facts(found),
        "drawn_as": drawn_as(network),
        "curves": curve_facts(found),
        "budget": budget_facts(found),
        "nodes": {name: _node(found, name, node) for name, node in found.plan.nodes.items()},
        "published": published_rows(found, nyquist),
        "conflicts": conflicts(network),
        "skipped": _skipped(skipped),
    }


def noise_ports(found: Evaluation) -> list[str]:
    """Ports of noise pictures, in the network's order."""
    return [
        f"{name}.{port}"
        for name, node in found.plan.nodes.items()
        for port in NOISE_PORTS
        if isinstance(node.outputs.get(port), Image) and not node.node.disabled
    ]


def picture_facts(found: Evaluation, port: str, role: str) -> dict[str, Any]:
    """Size, sampling and statistics of a picture; σ is of all its samples."""
    image: Image = found.plan.output(port)
    samples = realize(image, found.work)
    return {
        "port": port,
        "role": role,
        "columns": image.columns,
        "rows": image.rows,
        "interval_x_mrad": image.interval_x_mrad,
        "interval_y_mrad": image.interval_y_mrad,
        "unit": image.unit,
        "band_um": image.band_um,
        "minimum": float(samples.min()),
        "maximum": float(samples.max()),
        "mean": float(np.mean(samples, dtype=np.float64)),
        "sigma": float(np.std(samples, dtype=np.float64)),
    }


def _run(found: Evaluation) -> dict[str, Any]:
    import scipy

    policy = found.work.policy
    return {
        "date": time.strftime("%Y-%m-%d %H:%M %z"),
        "precision": policy.precision,
        "threads": policy.workers,
        "tolerance": policy.budget,
        "seed": found.network.seed,
        "seconds": dict(found.seconds),
        "versions": {
            "imagechain": version(),
            "python": ".".join(map(str, sys.version_info[:3])),
            "numpy": np.__version__,
            "scipy": scipy.__version__,
        },
        "transforms": backend(),
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
    for each in skipped:
        said = asdict(each)
        nodes.setdefault(said.pop("node"), []).append(said)
    return nodes


def _node(found: Evaluation, name: str, node: PlannedNode) -> dict[str, Any]:
    declared = node.declaration
    values = found.readouts.get(name, {})
    assert node.module is not None
    return {
        "module": declared.key,
        "title": declared.title,
        "group": declared.group,
        "summary": declared.summary,
        "disabled": node.node.disabled,
        "neutral": is_neutral(node),
        "seconds": found.work.seconds.get(name, 0.0),
        "set": sorted(thaw(node.node.params)),
        "parameters": {
            each.name: {"value": plain(getattr(node.module, each.name)), "unit": each.param.unit}
            for each in declared.parameters
        },
        "readouts": {
            each.name: {"value": values[each.name], "unit": each.unit, "meaning": each.meaning}
            for each in declared.readouts
            if each.name in values
        },
        "tables": {
            port: [
                {"name": r.name, "value": r.value, "unit": r.unit, "meaning": r.meaning}
                for r in realize(value, found.work).rows
            ]
            for port, value in node.outputs.items()
            if isinstance(value, Table)
        },
    }
