"""The HTML report: one file that needs no other, light and fit to print."""

from collections.abc import Sequence
from typing import Any

from app.report import html_page as html
from app.report.budget import budget, spectrum
from app.report.data_sheet_facts import DIFFERENT, REPRODUCED, TIMES
from app.report.drawing import picture_drawing as drawing
from app.report.drawing.curves import MOST, Part, curves_png, node_curves, product_png, stages_png
from app.report.edge_measurement import judged
from app.run.evaluation import Evaluation, figure_rows, reduced, way_in_words
from app.run.terminal import four_digits, sized
from app.run.transfer_chain import Responses
from core.chain.engine import realize
from core.records import replace

_MOST_INPUTS = 2
_MOST_OTHERS = 4
_MOST_NOISES = 8
_MOST_NAMES = 24


def page(evaluation: Evaluation, facts: dict[str, Any]) -> str:
    network = facts["network"]
    title = network["name"] or "Image chain"
    figures = figure_rows(facts["figures"], drawing.number)
    rows = [(name, f"{value} {unit}") for name, value, unit, _ in figures]
    card = html.report_grid(("figure", "value"), rows, numbers=(1,), kind="card") if rows else ""
    blocks = [
        html.paragraph(network["description"], "lead") if network["description"] else "",
        html.beside((card, _shown_pictures(evaluation, _of_the_chain(facts)))),
        _warnings(facts),
        _run_line(facts),
        data_sheet(facts),
        _pictures(evaluation, facts),
        _published(facts),
        spectrum(facts),
        transfer(evaluation, facts),
        judged(facts),
        _pupils(evaluation),
        _curves(evaluation),
        _noise(evaluation, facts),
        budget(facts),
        _readouts(facts),
        economy(facts),
        _nodes(facts),
    ]
    return html.page(title, blocks)


def _run_line(facts: dict[str, Any]) -> str:
    run = facts["run"]
    versions = " · ".join(f"{name} {release}" for name, release in run["versions"].items())
    words = [
        f"{run['precision']} precision",
        f"error budget {drawing.number(float(format(run['tolerance'], '.3g')))}",
        f"seed {run['seed']}",
        f"{run['threads']} threads" if run["threads"] != 1 else "1 thread",
        f"{run['seconds']['total']:.2f} s",
        versions,
        f"transforms by {run['transforms']}",
        *([way_in_words(run["way"])] if run["way"] else []),
        run["date"],
    ]
    return html.paragraph(" · ".join(words), "run")


def _warnings(facts: dict[str, Any]) -> str:
    lines = [
        f"{one['node']}: {one['message']}. {one['remedy'][:1].upper()}{one['remedy'][1:]}."
        for one in facts["warnings"]
    ]
    return html.heading(2, "Warnings") + html.items(lines, "warnings") if lines else ""


def _of_the_chain(facts: dict[str, Any]) -> list[dict[str, Any]]:
    inputs = [picture for picture in facts["pictures"] if picture["role"] == "input"]
    outputs = [picture for picture in facts["pictures"] if picture["role"] == "output"]
    return [*inputs[:_MOST_INPUTS], *outputs]


def _pictures(evaluation: Evaluation, facts: dict[str, Any]) -> str:
    if not facts["pictures"]:
        return ""
    others = [picture for picture in facts["pictures"] if picture["role"] == "other output"]
    names = ("minimum", "maximum", "mean", "sigma")
    rows = [
        (one["port"], *(drawing.number(_clean(one, name)) for name in names), one["unit"])
        for one in facts["pictures"]
    ]
    heads = ("picture", "minimum", "maximum", "mean", "σ", "unit")
    return (
        html.heading(2, "Input and output")
        + _other_pictures(evaluation, others, len(_of_the_chain(facts)))
        + html.report_grid(heads, rows, numbers=(1, 2, 3, 4))
    )


def _shown_pictures(evaluation: Evaluation, shown: list[dict[str, Any]]) -> str:
    """Figure of the chain's pictures; none where several end unlinked and no chain begins."""
    if not shown:
        return ""
    drawn = drawing.pictures_png(
        [_picture(evaluation, one, one["role"].capitalize()) for one in shown]
    )
    steps = [(one["interval_x_mrad"], one["interval_y_mrad"]) for one in shown]
    sizes = [
        f" (sample size {drawing.number(x)} × {drawing.number(y)} mrad)" if x and y else ""
        for x, y in steps
    ]
    alike = [
        f"{one['port']}: {one['columns']} × {one['rows']} samples" + size
        for one, size in zip(shown, sizes, strict=True)
    ]
    caption = "; ".join(alike) + ". Grey levels span each picture's own 0.1 % to 99.9 % quantiles."
    return html.drawn(drawn, caption, "input and output pictures")


def _clean(picture: dict[str, Any], name: str) -> float:
    """A statistic; 0 where it is the rounding of the picture's values."""
    value: float = picture[name]
    largest = max(abs(picture["minimum"]), abs(picture["maximum"]))
    return 0.0 if abs(value) < 1e-15 * largest else value


def _other_pictures(evaluation: Evaluation, others: list[dict[str, Any]], beside: int) -> str:
    if not others:
        return ""
    shown, rest = others[:_MOST_OTHERS], others[_MOST_OTHERS:]
    drawn = drawing.pictures_png([_picture(evaluation, one, one["port"]) for one in shown], beside)
    more = _not_shown([picture["port"] for picture in rest])
    return html.drawn(
        drawn, "Other output pictures of the network." + more, "other output pictures"
    )


def _not_shown(ports: Sequence[str]) -> str:
    return f" Not shown: {_listed(ports)}." if ports else ""


def _listed(names: Sequence[str]) -> str:
    more = len(names) - _MOST_NAMES
    return ", ".join(names[:_MOST_NAMES]) + (f" and {more} more" if more > 0 else "")


def _picture(evaluation: Evaluation, picture: dict[str, Any], title: str) -> tuple[str, Any, Any]:
    image = evaluation.plan.output(picture["port"])
    return title, image, reduced(realize(image, evaluation.work), evaluation.work)


def _published(facts: dict[str, Any]) -> str:
    rows = facts["published"]
    blocks = ""
    if rows:
        good = sum(row["verdict"] == REPRODUCED for row in rows)
        heads = ("figure", "where", "published", "here", "unit", "verdict", "reason")
        marks = {REPRODUCED: "good", DIFFERENT: "bad"}
        blocks += (
            html.heading(2, "Comparison with published figures")
            + html.paragraph(f"Published figures reproduced: {good} of {len(rows)}.")
            + html.report_grid(
                heads, list(map(_published_cells, rows)), (2, 3), {5: marks}, "published"
            )
        )
    if facts["conflicts"]:
        blocks += html.heading(3 if rows else 2, "Conflicts within the source")
        blocks += html.items(facts["conflicts"])
    return blocks


def _published_cells(row: dict[str, Any]) -> tuple[str, ...]:
    within = "" if row["within"] is None else f" ± {drawing.number(row['within'])}"
    values = drawing.number(row["value"]) + within, drawing.number(row["ours"])
    reason = "" if row["verdict"] == REPRODUCED else row["reason"]
    return row["figure"], row["where"], *values, row["unit"], row["verdict"], reason


def _pupils(evaluation: Evaluation) -> str:
    panels, left_out = drawing.pupil_panels(evaluation)
    if not panels:
        return ""
    titles = {
        "samples": "amplitude transmission of the exit pupils (axes in samples)",
        "cyc/mrad": (
            "autocorrelations of the pupils, each on its own frequency grid (axes in cyc/mrad)"
        ),
    }
    kinds = [text for unit, text in titles.items() if any(panel[-1] == unit for panel in panels)]
    caption = "; ".join(kinds).capitalize() + (". Grey levels are linear from minimum to maximum.")
    more = _not_shown(left_out)
    drawn = drawing.panels_png(panels)
    shown = html.drawn(drawn, caption + more, "exit pupils and autocorrelations")
    return html.heading(2, "Pupils") + shown


def _curves(evaluation: Evaluation) -> str:
    curves = node_curves(evaluation)
    if not curves:
        return ""
    caption = "Curves of the nodes; a gap means that the curve has no value there."
    caption += _not_shown([port for port, _ in curves[MOST:]])
    return html.heading(2, "Curves") + html.drawn(
        curves_png(curves[:MOST]), caption, "curves of nodes"
    )


def _noise(evaluation: Evaluation, facts: dict[str, Any]) -> str:
    alive = [picture for picture in facts["noise"] if picture["maximum"] != picture["minimum"]]
    still = [picture["port"] for picture in facts["noise"] if picture not in alive]
    if not facts["noise"]:
        return ""
    blocks = html.heading(2, "Noise")
    if alive:
        drawn = drawing.noise_png(
            [_picture(evaluation, one, one["port"]) for one in alive[:_MOST_NOISES]]
        )
        caption = (
            "Noise pictures, with grey levels spanning their 0.1 % to 99.9 % quantiles, "
            "and their histograms."
        )
        caption += _not_shown([picture["port"] for picture in alive[_MOST_NOISES:]])
        blocks += html.drawn(drawn, caption, "noise pictures and histograms")
    if still:
        blocks += html.paragraph(f"Constant noise pictures, not drawn: {_listed(still)}.")
    return blocks


def _readouts(facts: dict[str, Any]) -> str:
    blocks = ""
    nodes = 0
    for name, node in facts["nodes"].items():
        rows = [
            (readout, drawing.number(one["value"], one["unit"]), one["unit"], one["meaning"])
            for readout, one in node["readouts"].items()
            if one["value"] is not None
        ]
        # A table often has the read-outs again.
        rows += [
            (row["name"], drawing.number(row["value"], row["unit"]), row["unit"], row["meaning"])
            for table in node["tables"].values()
            for row in table
            if row["name"] not in node["readouts"] and row["value"] is not None
        ]
        nodes += bool(rows)
        if rows and nodes <= html.MOST_ROWS:
            heads = ("read-out", "value", "unit", "meaning")
            blocks += html.heading(3, node["title"], aside=name)
            blocks += html.report_grid(heads, rows, numbers=(1,), kind="readouts")
    if nodes > html.MOST_ROWS:
        blocks += html.paragraph(html.first_of(nodes, "nodes with read-outs"))
    return html.heading(2, "Read-outs") + blocks if blocks else ""


def _nodes(facts: dict[str, Any]) -> str:
    rows = []
    for name, node in facts["nodes"].items():
        values = [
            f"{name} = {drawing.number(given['value'])} {given['unit']}".rstrip()
            for name, given in ((each, node["parameters"][each]) for each in node["set"])
        ]
        said = state(facts["skipped"].get(name, []))
        took = f"{1e3 * node['seconds']:.1f} ms"
        rows.append((name, node["title"], ", ".join(values), said, took))
    seconds = facts["run"]["seconds"]
    words = (
        "Parameters that are not listed have their defaults. A node that only multiplies the "
        "spectrum takes no time of its own: its factor is applied in the node that computes the "
        f"picture. Reading the input pictures took {seconds['sources']:.3f} s and the evaluation "
        f"{seconds['evaluation']:.3f} s; the run took {seconds['total']:.3f} s before this report."
    )
    heads = ("node", "module", "set", "", "time")
    return (
        html.heading(2, "Nodes")
        + html.report_grid(heads, rows, numbers=(4,))
        + html.paragraph(words)
    )


# The section that reads as a camera's data sheet.

Fact = dict[str, Any]


def data_sheet(facts: Fact) -> str:
    sheet = facts["data_sheet"]
    if sheet is None:
        return ""
    blocks = html.heading(2, "Data sheet")
    for group in sheet["groups"]:
        rows = [(r["label"], *_values(r["values"], r["unit"], r["between"])) for r in group["rows"]]
        if rows:
            blocks += html.heading(3, group["title"], group["node"])
            blocks += html.report_grid(("figure", "value", "unit"), rows, numbers=(1,))
    for noise in sheet["noises"]:
        rows = [
            (row["label"], *(" ".join(_quantity(row[unit], unit)) for unit in ("e-", "K")))
            for row in noise["rows"]
        ]
        blocks += html.heading(3, "Noise by source", noise["node"])
        blocks += html.report_grid(("noise", "electrons", "kelvin"), rows, numbers=(1, 2))
    mtf = sheet["mtf"]
    if mtf is not None:
        x, y = _rounded(mtf["nyquist_x"]), _rounded(mtf["nyquist_y"])
        blocks += html.heading(3, "MTF at the pixels' Nyquist frequency")
        where = f"At {x} cyc/mrad horizontally and {y} vertically"
        blocks += html.paragraph(f"{where}: half a cycle per pixel of the final picture.")
        shown = [(r["label"], r["node"], _rounded(r["x"]), _rounded(r["y"])) for r in mtf["rows"]]
        blocks += html.report_grid(
            ("stage", "node", "horizontal", "vertical"), shown, numbers=(2, 3)
        )
        rer = f"{_rounded(mtf['edge_x'])} horizontal, {_rounded(mtf['edge_y'])} vertical"
        what = "the rise of a blurred edge across one pixel, as a fraction of the edge's height"
        blocks += html.paragraph(f"Relative edge response (RER): {rer}. RER is {what}.")
    return blocks


def _values(values: list[Any], unit: str, between: str) -> tuple[str, str]:
    """One value, or both with what stands between them, and the unit."""
    if len(values) == 1:
        return _quantity(values[0], unit)
    written = {_quantity(value, unit)[1] for value in values}
    shown = [_rounded(value) for value in values]
    if len(written) == 1:
        shown = [_quantity(value, unit)[0] for value in values]
        (unit,) = written
    if between == TIMES and shown[0] == shown[1] and not isinstance(values[0], int):
        return shown[0], unit
    return between.join(shown), unit


def _quantity(value: Any, unit: str) -> tuple[str, str]:
    value, unit = sized(value, unit)
    return drawing.number(value), unit


def _rounded(value: Any) -> str:
    return drawing.number(four_digits(value))


# The section on transfer functions: figures of every stage and of their product, and a table.


def transfer(evaluation: Evaluation, facts: Fact) -> str:
    responses, chain = evaluation.responses, evaluation.chain
    acting = any(stage.acts for stage in responses.stages)
    if not acting and not responses.beside:
        return ""
    blocks = html.heading(2, "Transfer functions")
    drawn_as = facts["drawn_as"]
    if acting:
        caption = (
            "MTF of every stage, signed, at the frequencies of the picture's FFT: a. horizontal, "
            "b. vertical. "
        )
        caption += (
            "Total: the product of the MTFs before pixels are combined."
            if chain.cascade
            else f"The stages are not in one chain, so there is no total MTF: {chain.missing}."
        )
        caption = drawing.named(caption, drawn_as.get("stages"))
        blocks += _stages(evaluation, responses, caption, "every stage")
    if acting and responses.products:
        caption = "Product of the MTFs of all stages, horizontal and vertical."
        if responses.products[1:]:
            caption = (
                "Product of the MTFs of all stages, including the electronics, horizontal and "
                "vertical."
            )
        drawn = product_png(responses, chain)
        blocks += html.drawn(
            drawn, drawing.named(caption, drawn_as.get("total")), "product of the MTFs"
        )
    if responses.beside:
        alone = replace(responses, stages=responses.beside, products=())
        caption = "Transfer functions of stages that are not on the path to the output shown."
        blocks += _stages(evaluation, alone, caption, "further stages")
    return blocks + _at_nyquist(responses, facts["transfer"]["at_nyquist"])


def _stages(evaluation: Evaluation, shown: Responses, caption: str, what: str) -> str:
    blocks = ""
    captions: dict[Part, str] = {
        "mtf": caption,
        "ptf": "PTFs of the stages in the figure above, in radians.",
    }
    for part, text in captions.items():
        acting = sum(s.has_phase if part == "ptf" else s.has_blur for s in shown.stages)
        if acting:
            drawn = stages_png(shown, evaluation.chain, part)
            blocks += html.drawn(drawn, text + html.of_many(acting), f"{part.upper()} of {what}")
    return blocks


def _at_nyquist(responses: Responses, nyquist: Fact) -> str:
    rows = []
    for stage in (*responses.stages, *responses.beside, *responses.products):
        names = (f"{stage.name}.{part}_nyquist_{axis}" for axis in "xy" for part in ("mtf", "ptf"))
        values = (drawing.number(nyquist[name], unit="rad") for name in names)
        rows.append((stage.title, "" if stage.is_product else stage.name, *values))
    place = "at the FFT's Nyquist frequency"
    heads = (place, "node", "MTF x", "PTF x (rad)", "MTF y", "PTF y (rad)")
    return html.report_grid(heads, rows, numbers=(2, 3, 4, 5))


# The section on what was not computed, and why.

# Of each kind: what is saved, why, and what is told of each node.
_KINDS = {
    "disabled": ("the node", "it is disabled", ""),
    "identity": ("the node", "the settings leave the picture unchanged", ""),
    "below_budget": (
        "a stage",
        "the effect is below the error budget, {budget} of the picture's range",
        "at most {bound} of the range",
    ),
    "wavelengths": (
        "Fourier transforms of every band",
        "a few wavelengths represent all bands",
        "{share} % of the transforms computed, error at most {bound} of a band's rms contrast",
    ),
    "region": ("pictures outside a region", "only the region is needed", "{share} % computed"),
    "unchanged": (
        "values computed before",
        "the inputs have not changed",
        "{share} % of the steps computed",
    ),
    "unseen": ("full output arrays", "nothing needs the full arrays", "{ports}"),
}


def economy(facts: Fact) -> str:
    budget = drawing.short(facts["run"]["tolerance"], 2)
    rows = []
    for kind, (what, why, detail) in _KINDS.items():
        where = [
            node + _detail(detail, fact)
            for node, listed in facts["skipped"].items()
            for fact in listed
            if fact["kind"] == kind and fact["share"] != 1  # a region may take the whole picture
        ]
        if where:
            more = (
                f" and {len(where) - html.MOST_ROWS:,} more" if len(where) > html.MOST_ROWS else ""
            )
            rows.append(
                (what, why.format(budget=budget), ", ".join(where[: html.MOST_ROWS]) + more)
            )
    if not rows:
        return ""
    heads = ("not computed", "because", "where")
    return html.heading(2, "Skipped computations") + html.report_grid(heads, rows, kind="economy")


def state(listed: list[Fact]) -> str:
    """A node's state in a word or two; empty where its own work was done."""
    for fact in listed:
        if fact["kind"] == "disabled":
            return "disabled"
        if fact["kind"] == "identity":
            return "neutral: skipped"
        if fact["kind"] == "below_budget":
            return f"left out: effect at most {drawing.short(fact['bound'], 2)} of the range"
    return ""


def _detail(template: str, fact: Fact) -> str:
    bound = drawing.short(fact["bound"], 2)
    share = drawing.short(None if fact["share"] is None else 100 * fact["share"], 2)
    told = template.format(bound=bound, share=share, ports=", ".join(fact["ports"]))
    return f" ({told})" if told else ""
