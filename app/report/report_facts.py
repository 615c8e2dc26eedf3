"""Reports of a run: one self-contained file, for people (HTML) or for programs (JSON)."""

import time
from pathlib import Path
from typing import Any

from app.report import budget, edge_measurement
from app.report.data_sheet_facts import data_sheet_facts, published_facts
from app.report.drawing import curves, picture_drawing
from app.run import terminal, transfer_chain
from app.run.evaluation import Evaluation, main_figures
from core import atomic, errors
from core.chain import engine, wires
from core.chain.skipped import Skip
from core.modules.parameters import plain
from core.records import asdict
from core.transfer.periodic import backend
from nodes.files.file_format import JSON
from nodes.input_output.sample_unit import statistics

NOISE_PORTS = ("noise", "detector_noise", "quantization_error")


def write_report(evaluation: Evaluation, skipped: tuple[Skip, ...], path: Path) -> None:
    facts = report_facts(evaluation, skipped)
    if JSON.matches(path):
        text = terminal.json_text(facts, indent=1)
    else:
        from app.report.report_page import page

        text = errors.printable(page(evaluation, facts))
    atomic.write_text(path, text)


def report_facts(evaluation: Evaluation, skipped: tuple[Skip, ...]) -> dict[str, Any]:
    network, chain = evaluation.network, evaluation.chain
    nyquist = transfer_chain.at_nyquist(chain, evaluation.work)
    nodes = {name: _node(evaluation, name, node) for name, node in evaluation.plan.nodes.items()}
    return {
        "format": "imagechain-report",
        "version": 1,
        "network": {
            **terminal.values_of(network, "name", "description"),
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
                for port in transfer_chain.ending_images(evaluation.plan)
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
        "judged": edge_measurement.judged_facts(evaluation),
        "drawn_as": picture_drawing.drawn_as(network),
        "curves": curves.curve_facts(evaluation),
        "budget": budget.budget_facts(evaluation),
        "spectra": budget.spectrum_facts(evaluation),
        "figures": main_figures(evaluation),
        "data_sheet": data_sheet_facts(evaluation, nodes),
        "nodes": nodes,
        **published_facts(evaluation, nyquist),
        "skipped": _skipped(skipped),
    }


def noise_ports(evaluation: Evaluation) -> list[str]:
    return [
        f"{name}.{port}"
        for name, node in evaluation.plan.nodes.items()
        for port in NOISE_PORTS
        if isinstance(node.outputs.get(port), wires.Image) and not node.node.disabled
    ]


def picture_facts(evaluation: Evaluation, port: str, role: str) -> dict[str, Any]:
    """Size, sampling and statistics of a picture; σ is of all its samples."""
    image: wires.Image = evaluation.plan.output(port)
    seen = statistics(engine.realize(image, evaluation.work), for_each=evaluation.work.for_each)
    names = ("columns", "rows", "interval_x_mrad", "interval_y_mrad", "unit", "band_um")
    return {"port": port, "role": role, **terminal.values_of(image, *names), **asdict(seen)}


def _run(evaluation: Evaluation) -> dict[str, Any]:
    policy = evaluation.work.policy
    return {
        "date": time.strftime("%Y-%m-%d %H:%M %z"),
        "precision": policy.precision,
        "threads": policy.workers,
        "tolerance": policy.budget,
        "seed": evaluation.network.seed,
        "seconds": dict(evaluation.seconds),
        "versions": terminal.versions(),
        "transforms": backend(),
        "way": dict(evaluation.way),
    }


def _stage(stage: transfer_chain.StageResponse) -> dict[str, Any]:
    return {
        "name": stage.name,
        "title": stage.title,
        "mtf_x": stage.x.mtf,
        "ptf_x_rad": stage.x.ptf_rad,
        "mtf_y": stage.y.mtf,
        "ptf_y_rad": stage.y.ptf_rad,
    }


def _skipped(skipped: tuple[Skip, ...]) -> dict[str, list[dict[str, Any]]]:
    nodes: dict[str, list[dict[str, Any]]] = {}
    for skip in skipped:
        said = asdict(skip)
        nodes.setdefault(said.pop("node"), []).append(said)
    return nodes


def _node(evaluation: Evaluation, name: str, node: engine.PlannedNode) -> dict[str, Any]:
    declared, units = node.declaration, node.units
    values = evaluation.readouts.get(name, {})
    assert node.module is not None
    return {
        "module": declared.key,
        **terminal.values_of(declared, "title", "group", "summary"),
        "disabled": node.node.disabled,
        "neutral": node.is_neutral,
        "seconds": evaluation.work.seconds.get(name, 0.0),
        "set": sorted(errors.thaw(node.node.params)),
        "parameters": {
            each.name: {"value": plain(getattr(node.module, each.name)), "unit": each.param.unit}
            for each in declared.parameters
        },
        "readouts": {
            r.name: {"value": values[r.name], "unit": units[r.name], "meaning": r.meaning}
            for r in declared.readouts
            if r.name in values
        },
        "tables": {
            port: [
                terminal.values_of(r, "name", "value", "unit", "meaning")
                for r in engine.realize(value, evaluation.work).rows
            ]
            for port, value in node.outputs.items()
            if isinstance(value, wires.Table)
        },
    }
