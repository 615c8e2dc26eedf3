"""Sections of the report: mean spectra, and which stage adds how much noise and blur."""

from collections.abc import Callable
from itertools import cycle
from typing import Any

import numpy as np

from app.report import html_page as html
from app.report.drawing import picture_drawing as drawing
from app.report.drawing.curves import draw_on
from app.run.evaluation import Evaluation
from core.chain.band_stack import BandStack
from core.chain.wires import CurveData, Image, Series
from core.errors import FAULTS, DataError
from core.evaluation.work import Work
from core.modules.declaration import NodeContext
from core.records import asdict
from nodes.analysis import noise_budget
from nodes.analysis.lineage import NoiseOf, noise_free, transfer_of
from nodes.input_output.sample_unit import statistics

Fact = dict[str, Any]


def budget_facts(evaluation: Evaluation) -> Fact:
    """Noise and blur by stage; of what there is none, the reason."""
    noise, noise_reason = _tried(lambda: _noise_facts(evaluation))
    blur, blur_reason = _tried(lambda: _blur_facts(evaluation))
    return {"noise_reason": noise_reason, "noise": noise, "blur_reason": blur_reason, "blur": blur}


def _tried(make: Callable[[], Fact]) -> tuple[Fact | None, str | None]:
    """What is made, or why it cannot be: the run itself has not failed."""
    try:
        return make(), None
    except FAULTS as error:
        return None, str(error)


def _final(evaluation: Evaluation) -> tuple[str, Image, Work]:
    port = evaluation.chain.final
    if port is None:
        raise DataError("the network has no final picture")
    return port, evaluation.plan.output(port), evaluation.engine.work(evaluation.work.policy)


def _noise_facts(evaluation: Evaluation) -> Fact:
    port, image, work = _final(evaluation)
    if evaluation.work.blocks is not None:
        raise DataError(
            "the pictures are computed in blocks, but noise can only be traced through whole "
            "pictures"
        )
    predicted = noise_budget.noise_shares(work, work.value(NoiseOf(image)), kind="all")
    if not predicted.shares:
        raise DataError(f"no noise is added on the way to {port}")
    of_picture, reason = _tried(lambda: _noise_of(work, image))
    return {
        "port": port,
        "unit": image.unit,
        "summed": predicted.sigma,
        "temporal": predicted.temporal,
        "fixed": predicted.fixed,
        **(of_picture or {"together": None, "together_mean": None}),
        "together_reason": reason,
        "sources": [_source(evaluation, share) for share in predicted.shares],
    }


def _noise_of(work: Work, image: Image) -> Fact:
    clean = work.value(noise_free(image.recipe))
    noise = statistics(np.subtract(work.value(image.recipe), clean), for_each=work.for_each)
    return {"together": noise.sigma, "together_mean": noise.mean}


def _source(evaluation: Evaluation, share: noise_budget.NoiseShare) -> Fact:
    planned = evaluation.plan.nodes.get(share.node)
    return {
        **asdict(share),
        "title": planned.declaration.title if planned else share.node,
        "sigma": share.sigma,
        "share": share.share_temporal + share.share_fixed,
    }


def _blur_facts(evaluation: Evaluation) -> Fact:
    port, image, work = _final(evaluation)
    passed = transfer_of(image)
    grid = evaluation.chain.combined or evaluation.chain.grid or image.grid()
    stages, half = passed.part("mtf"), (0.5 * grid.nyquist_x, 0.5 * grid.nyquist_y)
    blur = noise_budget.blur_shares(work, stages=stages, frequency=half)
    before = noise_budget.unknown_before(passed)
    if not blur and before is not None:
        raise DataError(f"{before} has no known transfer function")
    if not blur:
        raise DataError(f"every transfer function before {port} is 1")
    return {
        "xi_cyc_per_mrad": half[0],
        "eta_cyc_per_mrad": half[1],
        "behind": before,
        "mtf_x": noise_budget.mtf_of_all(blur, 0),
        "mtf_y": noise_budget.mtf_of_all(blur, 1),
        "stages": [
            {"node": one.node, "title": one.label, **_of_axis(one, 0, "x"), **_of_axis(one, 1, "y")}
            for one in blur
        ],
    }


def _of_axis(share: Any, place: int, axis: str) -> Fact:
    return {f"mtf_{axis}": share.mtf[place], f"share_{axis}": share.share[place]}


def budget(facts: Fact) -> str:
    contributions = facts["budget"]
    noise, blur = contributions["noise"], contributions["blur"]
    blocks = html.heading(2, "Contributions to noise and blur")
    if noise or blur:
        told = ["Noise: share of the noise variance in the final picture."] if noise else []
        told += ["Blur: share of −ln |MTF| at half the Nyquist frequency."] if blur else []
        caption = " ".join(told)
        caption += html.of_many(len(noise["sources"]), "noise sources") if noise else ""
        caption += html.of_many(len(blur["stages"])) if blur else ""
        blocks += html.drawn(bars_png(noise, blur), caption, "shares of noise and blur")
    for what, section, shares in (("Noise", _noise, noise), ("Blur", _blur, blur)):
        reason = contributions[f"{what.lower()}_reason"]
        unknown = html.paragraph(f"{what} cannot be split among its sources: {reason}.")
        blocks += section(shares) if shares else unknown
    return blocks


def bars_png(noise: Fact | None, blur: Fact | None) -> bytes:
    panels = []
    if noise:
        rows = noise["sources"]
        names = [noise_budget.source_title(row["name"]) for row in rows]
        kinds = ("temporal", "fixed")
        keys = {k: f"share_{k}" for k in kinds if any(row[k] is not None for row in rows)}
        panels.append(_bars("Noise", "share of the variance (%)", rows, names, keys))
    if blur:
        rows, keys = blur["stages"], {"horizontal": "share_x", "vertical": "share_y"}
        names = [row["title"] for row in rows]
        panels.append(_bars("Blur", "share of −ln |MTF| (%)", rows, names, keys))
    most = max(len(panel.bars) for panel in panels)
    with drawing.figure(10.0 if len(panels) == 2 else 6.6, 1.3 + 0.42 * most) as (drawn, out):
        axes = drawn.subplots(1, len(panels), squeeze=False)[0]
        for axis, panel in zip(axes, panels, strict=True):
            draw_on(axis, panel)
            axis.set_title(panel.title)
            drawing.legend_below(axis, 4.0, 8.5)
    return out.getvalue()


def _bars(
    title: str, label: str, rows: list[Fact], names: list[str], keys: dict[str, str]
) -> CurveData:
    """The greatest shares in percent, with their node where two names are alike."""
    shares = np.array([[100.0 * row[key] for row in rows] for key in keys.values()])
    shown = drawing.strongest([*np.abs(shares).sum(axis=0)])
    pairs = [(names[at], rows[at]["node"]) for at in shown]
    places = np.arange(float(len(shown)))
    drawn = [[float(format(share, ".3g")) for share in along] for along in shares[:, shown]]
    series = (Series(key, places, np.array(along)) for key, along in zip(keys, drawn, strict=True))
    return CurveData(title, "", label, tuple(series), bars=noise_budget.distinct(pairs))


def _percent(share: float) -> str:
    """A share in percent; what rounds to nothing is shown as a bound."""
    if share != 0.0 and abs(share) < 5e-4:
        return "<0.05" if share > 0.0 else ">\u22120.05"
    return drawing.number(float(format(100.0 * share, ".3g")))


def _noise(noise: Fact) -> str:
    together = {"node": "", "temporal": noise["temporal"], "fixed": noise["fixed"], "share": 1.0}
    titles = [
        *(noise_budget.source_title(source["name"]) for source in noise["sources"]),
        "All together",
    ]
    rows = [
        (
            title,
            one["node"],
            drawing.number(one["temporal"]),
            drawing.number(one["fixed"]),
            _percent(one["share"]),
        )
        for title, one in zip(titles, [*noise["sources"], together], strict=True)
    ]
    unit = f" ({noise['unit']})" if noise["unit"] else ""
    heads = ("noise", "node", f"σ temporal{unit}", f"σ fixed{unit}", "share (%)")
    text = (
        f"Noise predicted for {noise['port']}, averaged over all sensors of the same design. "
        "Temporal noise changes from frame to frame; fixed patterns stay the same. "
        f"{_beside(noise)}"
    )
    heading = html.heading(3, "Noise in the final picture")
    return heading + html.paragraph(text) + html.report_grid(heads, rows, numbers=(2, 3, 4))


def _beside(noise: Fact) -> str:
    all_noise = f"All noise: σ = {drawing.number(noise['summed'])} predicted"
    if noise["together"] is None:
        reason = noise["together_reason"]
        return f"{all_noise}; the noise in this picture is not known: {reason}."
    unit = f" {noise['unit']}" if noise["unit"] else ""
    together, mean = drawing.number(noise["together"]), drawing.number(noise["together_mean"])
    return (
        f"{all_noise}, {together}{unit} simulated in this picture; the noise changes the "
        f"picture's mean by {mean}{unit}."
    )


def _blur(blur: Fact) -> str:
    xi, eta = drawing.number(blur["xi_cyc_per_mrad"]), drawing.number(blur["eta_cyc_per_mrad"])
    rows = [
        (one["title"], one["node"], drawing.number(one["mtf_x"]), _percent(one["share_x"]),
         drawing.number(one["mtf_y"]), _percent(one["share_y"]))
        for one in blur["stages"]
    ]  # fmt: skip
    rows.append(
        ("All together", "", drawing.number(blur["mtf_x"]), "", drawing.number(blur["mtf_y"]), "")
    )
    heads = ("stage", "node", "|MTF| x", "share x (%)", "|MTF| y", "share y (%)")
    text = f"|MTF| of each stage at {xi} cyc/mrad horizontally and {eta} vertically."
    if blur["behind"] is not None:
        text += (
            f" {blur['behind']} has no known transfer function, so only the stages after it are "
            "listed."
        )
    heading = html.heading(3, "Blur by stage")
    return heading + html.paragraph(text) + html.report_grid(heads, rows, numbers=(2, 3, 4, 5))


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


def spectrum(facts: Fact) -> str:
    spectra, responses = facts["spectra"]["means"], facts["spectra"]["responses"]
    if not spectra:
        return ""
    caption = "Mean of each picture in each band."
    if responses:
        caption = (
            "Left axis: mean of each picture in each band. Right axis: response at each "
            "wavelength, from 0 to 1."
        )
    caption += html.of_many(len(spectra), "spectra")
    drawn = html.drawn(spectra_png(spectra, responses), caption, "mean spectra and responses")
    return html.heading(2, "Spectrum") + drawn + _table(spectra)


def spectra_png(spectra: list[Fact], responses: list[Fact]) -> bytes:
    with drawing.figure(9.0, 3.9) as (drawn, out):
        axis = drawn.subplots()
        colours = cycle(drawing.COLOURS)
        units = list(dict.fromkeys(one["unit"] for one in spectra))
        for one, colour in zip(spectra[: drawing.MOST_DRAWN], colours, strict=False):
            axis.plot(
                one["centres_um"], one["mean"], color=colour, lw=1.6, ms=3, label=_ports(one),
                marker="o" if one["bands"] <= _FEW else None,
            )  # fmt: skip
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
                beside.plot(
                    one["wavelength_um"], one["values"], color=colour, lw=1.6, ls="--",
                    label=f"{one['name']} of {one['node']}",
                )  # fmt: skip
        drawn.legend(loc="outside lower center", ncols=2, fontsize=8.5)
    return out.getvalue()


def _ports(one: Fact) -> str:
    """The first of the ports with that mean, and the last."""
    ports = one["ports"]
    return ports[0] if len(ports) == 1 else f"{ports[0]} to {ports[-1]}"


def _table(spectra: list[Fact]) -> str:
    rows = []
    for one in spectra:
        low, high = one["band_um"]
        highest = max(range(one["bands"]), key=one["mean"].__getitem__)
        width, place = sum(one["widths_um"]) / one["bands"], one["centres_um"][highest]
        figures = map(drawing.short, (width, place, one["mean"][highest]))
        ends = f"{drawing.short(low)} to {drawing.short(high)}"
        rows.append(
            (", ".join(one["ports"]), drawing.number(one["bands"]), ends, *figures, one["unit"])
        )
    heads = ["picture", "bands", "from, to (µm)", "mean width (µm)"]
    heads += ["highest at (µm)", "mean there", "unit"]
    return html.report_grid(heads, rows, numbers=(1, 3, 4, 5))
