"""Pictures with bands of wavelength: their mean spectra, and the responses that weight them."""

from itertools import cycle
from typing import Any

from app.report.drawing.picture_drawing import COLOURS, MOST_DRAWN, figure, number, short
from app.report.html_page import Block, Drawn, Grid, Heading, of_many
from app.run.evaluation import Evaluation
from core.chain.band_stack import BandStack
from core.chain.wires import Image
from core.modules.declaration import NodeContext

Fact = dict[str, Any]
_FEW = 40  # bands up to which every one has a dot


def spectrum_facts(evaluation: Evaluation) -> Fact:
    """Mean spectra and responses; empty lists without bands."""
    spectra: dict[str, Fact] = {}
    for name, planned in evaluation.plan.nodes.items():
        for port, image in planned.outputs.items():
            if planned.node.disabled or not isinstance(image, Image) or image.bands is None:
                continue
            means = image.bands.means()
            if means.key not in spectra:
                values = evaluation.work.value(means)
                spectra[means.key] = _spectrum(image.bands, values, image.unit)
            spectra[means.key]["ports"].append(f"{name}.{port}")
    responses = _responses(evaluation) if spectra else []
    return {"means": list(spectra.values()), "responses": responses}


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
        drawn_of = getattr(planned.module, "response_over_band", None)
        if drawn_of is None or planned.node.disabled:
            continue
        drawn = drawn_of(planned, NodeContext(name, folder=evaluation.plan.folder))
        if drawn is not None:
            drawn_name, _, wavelength_um, values = drawn
            about = {"name": drawn_name, "wavelength_um": wavelength_um, "values": values}
            responses.append({"node": name, "title": planned.declaration.title, **about})
    return responses


def spectrum(facts: Fact) -> list[Block]:
    """The section; empty where no picture has bands."""
    spectra, responses = facts["spectra"]["means"], facts["spectra"]["responses"]
    if not spectra:
        return []
    caption = "Left: mean of each band of the pictures."
    if responses:
        caption += " Right: response at each wavelength, from 0 to 1."
    caption += of_many(len(spectra), "spectra")
    drawn = Drawn(spectra_png(spectra, responses), caption, "mean spectra and responses")
    return [Heading(2, "Spectrum"), drawn, _table(spectra)]


def spectra_png(spectra: list[Fact], responses: list[Fact]) -> bytes:
    with figure(9.0, 3.9) as (drawn, out):
        axis = drawn.subplots()
        colours = cycle(COLOURS)
        units = list(dict.fromkeys(one["unit"] for one in spectra))
        for one, colour in zip(spectra[:MOST_DRAWN], colours, strict=False):
            look = {"marker": "o" if one["bands"] <= _FEW else None, "label": _ports(one)}
            axis.plot(one["centres_um"], one["mean"], color=colour, lw=1.6, ms=3, **look)
        axis.set_xlabel("wavelength (µm)")
        axis.set_ylabel(f"mean ({', '.join(units)})" if any(units) else "mean")
        lowest = min(min(one["mean"]) for one in spectra)
        axis.set_ylim(bottom=min(0.0, lowest))
        if responses:
            beside = axis.twinx()
            beside.spines["right"].set_visible(True)
            beside.grid(visible=False)
            beside.set_ylim(0.0, 1.05)
            beside.set_ylabel("response")
            for one, colour in zip(responses, colours, strict=False):
                look = {"ls": "--", "label": f"{one['name']} of {one['node']}"}
                beside.plot(one["wavelength_um"], one["values"], color=colour, lw=1.6, **look)
        drawn.legend(loc="outside lower center", ncols=2, fontsize=8.5)
    return out.getvalue()


def _ports(one: Fact) -> str:
    """The first of the ports with that mean, and the last."""
    ports = one["ports"]
    return ports[0] if len(ports) == 1 else f"{ports[0]} to {ports[-1]}"


def _table(spectra: list[Fact]) -> Block:
    rows = []
    for one in spectra:
        low, high = one["band_um"]
        highest = max(range(one["bands"]), key=one["mean"].__getitem__)
        width, place = sum(one["widths_um"]) / one["bands"], one["centres_um"][highest]
        figures = map(short, (width, place, one["mean"][highest]))
        ends = f"{short(low)} to {short(high)}"
        rows.append((", ".join(one["ports"]), number(one["bands"]), ends, *figures, one["unit"]))
    heads = ["picture", "bands", "from, to (µm)", "mean width (µm)"]
    heads += ["highest at (µm)", "mean there", "unit"]
    return Grid(heads, rows, numbers=(1, 3, 4, 5))
