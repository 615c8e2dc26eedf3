"""The HTML report: one file that needs no other, light and fit to print."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

from app.report.budget_section import budget
from app.report.drawing.node_curves import MOST, curves_png, node_curves
from app.report.drawing.picture_drawing import noise_png, panels_png, pictures_png
from app.report.drawing.printed_numbers import number
from app.report.drawing.pupils import pupil_panels
from app.report.economy_section import economy, state
from app.report.edge_section import judged
from app.report.facts.published import DIFFERENT, REPRODUCED
from app.report.markup import figure, table
from app.report.page_style import CSS
from app.report.transfer_section import transfer
from app.run.evaluation import Evaluation
from core.chain.realize import realize

_MOST_INPUTS = 2
_MOST_OTHERS = 4
_MOST_NOISES = 8
_MOST_NAMES = 24


def page(found: Evaluation, facts: dict[str, Any]) -> str:
    """The report as HTML."""
    network = facts["network"]
    title = network["name"] or "Image chain"
    parts = [
        f"<h1>{escape(title)}</h1>",
        f"<p class=lead>{escape(network['description'])}</p>" if network["description"] else "",
        _run_line(facts),
        _warnings(facts),
        _pictures(found, facts),
        _published(facts),
        transfer(found, facts),
        judged(facts),
        _pupils(found),
        _curves(found),
        _noise(found, facts),
        budget(facts),
        _readouts(facts),
        economy(facts),
        _nodes(facts),
    ]
    body = "\n".join(part for part in parts if part)
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)} · Imagechain</title>\n<style>{CSS}</style>\n</head>\n"
        f"<body>\n<main>\n{body}\n</main>\n</body>\n</html>\n"
    )


def _run_line(facts: dict[str, Any]) -> str:
    run = facts["run"]
    versions = " · ".join(f"{name} {each}" for name, each in run["versions"].items())
    words = [
        f"{run['precision']} precision",
        f"error budget {number(float(format(run['tolerance'], '.3g')))}",
        f"seed {run['seed']}",
        f"{run['threads']} threads" if run["threads"] != 1 else "1 thread",
        f"{run['seconds']['total']:.2f} s",
        versions,
        f"transforms by {run['transforms']}",
        run["date"],
    ]
    return f"<p class=run>{escape(' · '.join(words))}</p>"


def _warnings(facts: dict[str, Any]) -> str:
    items = "".join(
        f"<li><b>{escape(each['node'])}</b>: {escape(each['message'])}. "
        f"<span>{escape(each['remedy'][:1].upper() + each['remedy'][1:])}.</span></li>"
        for each in facts["warnings"]
    )
    return f"<div class=warnings><h2>Warnings</h2><ul>{items}</ul></div>" if items else ""


def _pictures(found: Evaluation, facts: dict[str, Any]) -> str:
    shown = facts["pictures"]
    if not shown:
        return ""
    inputs = [each for each in shown if each["role"] == "input"]
    outputs = [each for each in shown if each["role"] == "output"]
    others = [each for each in shown if each["role"] == "other output"]
    shown = [*inputs[:_MOST_INPUTS], *outputs]
    rows = [
        (
            each["port"],
            *(number(_clean(each, name)) for name in ("minimum", "maximum", "mean", "sigma")),
            each["unit"],
        )
        for each in facts["pictures"]
    ]
    heads = ("picture", "minimum", "maximum", "mean", "σ", "unit")
    return (
        "<h2>Input and output</h2>"
        + _shown_pictures(found, shown)
        + _other_pictures(found, others, len(shown))
        + table(heads, rows, numbers=(1, 2, 3, 4))
    )


def _shown_pictures(found: Evaluation, shown: list[dict[str, Any]]) -> str:
    """Figure of the chain's pictures; none where several end unlinked and no chain begins."""
    if not shown:
        return ""
    drawn = pictures_png([_picture(found, each, each["role"].capitalize()) for each in shown])
    alike = [
        f"{each['port']}: {each['columns']} × {each['rows']} samples"
        + (
            f" of {number(each['interval_x_mrad'])} × {number(each['interval_y_mrad'])} mrad"
            if each["interval_x_mrad"] and each["interval_y_mrad"]
            else ""
        )
        for each in shown
    ]
    caption = (
        "; ".join(alike) + ". Each picture has grey levels of its own, between its 0.1 % and "
        "99.9 % quantiles."
    )
    return figure(drawn, caption, "input and output pictures")


def _clean(picture: dict[str, Any], name: str) -> float:
    """A statistic; 0 where it is the rounding of the picture's values."""
    value: float = picture[name]
    largest = max(abs(picture["minimum"]), abs(picture["maximum"]))
    return 0.0 if abs(value) < 1e-15 * largest else value


def _other_pictures(found: Evaluation, others: list[dict[str, Any]], beside: int) -> str:
    if not others:
        return ""
    shown, rest = others[:_MOST_OTHERS], others[_MOST_OTHERS:]
    drawn = pictures_png([_picture(found, each, each["port"]) for each in shown], beside)
    more = _not_shown([each["port"] for each in rest])
    return figure(drawn, "Other pictures the network ends in." + more, "other output pictures")


def _not_shown(ports: Sequence[str]) -> str:
    return f" Not shown: {_listed(ports)}." if ports else ""


def _listed(names: Sequence[str]) -> str:
    """Names in a row; of very many how many more there are."""
    more = len(names) - _MOST_NAMES
    return ", ".join(names[:_MOST_NAMES]) + (f" and {more} more" if more > 0 else "")


def _picture(found: Evaluation, each: dict[str, Any], title: str) -> tuple[str, Any, Any]:
    image = found.plan.output(each["port"])
    return title, image, realize(image, found.work)


def _published(facts: dict[str, Any]) -> str:
    rows = facts["published"]
    text = ""
    if rows:
        good = sum(row["verdict"] == REPRODUCED for row in rows)
        text += f"<h2>Beside the published figures</h2><p>{good} of {len(rows)} reproduced.</p>"
        text += table(
            ("figure", "where", "published", "here", "unit", "verdict", "reason"),
            [
                (
                    row["figure"],
                    row["where"],
                    _published_value(row),
                    number(row["ours"]),
                    row["unit"],
                    row["verdict"],
                    "" if row["verdict"] == REPRODUCED else row["reason"],
                )
                for row in rows
            ],
            numbers=(2, 3),
            kind="published",
            marks={5: {REPRODUCED: "good", DIFFERENT: "bad"}},
        )
    if facts["conflicts"]:
        items = "".join(f"<li>{escape(text)}</li>" for text in facts["conflicts"])
        level = "h3" if rows else "h2"
        text += f"<{level}>Conflicts within the source</{level}><ul>{items}</ul>"
    return text


def _published_value(row: dict[str, Any]) -> str:
    within = "" if row["within"] is None else f" ± {number(row['within'])}"
    return number(row["value"]) + within


def _pupils(found: Evaluation) -> str:
    panels, left_out = pupil_panels(found)
    if not panels:
        return ""
    told = {
        "samples": "amplitude transmission of the exit pupils (axes in samples)",
        "cyc/mrad": "autocorrelations of pupils at frequencies of their own (axes in cyc/mrad)",
    }
    kinds = [text for unit, text in told.items() if any(each.unit == unit for each in panels)]
    caption = "; ".join(kinds).capitalize() + ". Grey is linear from the least to the greatest."
    more = _not_shown(left_out)
    drawn = panels_png(panels)
    return "<h2>Pupils</h2>" + figure(drawn, caption + more, "exit pupils and autocorrelations")


def _curves(found: Evaluation) -> str:
    curves = node_curves(found)
    if not curves:
        return ""
    caption = "What nodes plot; gaps where there is no value."
    caption += _not_shown([port for port, _ in curves[MOST:]])
    return "<h2>Curves</h2>" + figure(curves_png(curves[:MOST]), caption, "curves of nodes")


def _noise(found: Evaluation, facts: dict[str, Any]) -> str:
    alive = [each for each in facts["noise"] if each["maximum"] != each["minimum"]]
    still = [each["port"] for each in facts["noise"] if each not in alive]
    if not facts["noise"]:
        return ""
    text = "<h2>Noise</h2>"
    if alive:
        drawn = noise_png([_picture(found, each, each["port"]) for each in alive[:_MOST_NOISES]])
        caption = "Noise pictures between their 0.1 % and 99.9 % quantiles, and their histograms."
        caption += _not_shown([each["port"] for each in alive[_MOST_NOISES:]])
        text += figure(drawn, caption, "noise pictures and histograms")
    if still:
        text += f"<p>The same everywhere: {escape(_listed(still))}.</p>"
    return text


def _readouts(facts: dict[str, Any]) -> str:
    text = ""
    for name, node in facts["nodes"].items():
        rows = [
            (each, number(one["value"], one["unit"]), one["unit"], one["meaning"])
            for each, one in node["readouts"].items()
            if one["value"] is not None
        ]
        # A table often has the read-outs again.
        rows += [
            (row["name"], number(row["value"], row["unit"]), row["unit"], row["meaning"])
            for table in node["tables"].values()
            for row in table
            if row["name"] not in node["readouts"] and row["value"] is not None
        ]
        if rows:
            text += f"<h3>{escape(node['title'])} <small>{escape(name)}</small></h3>"
            text += table(
                ("read-out", "value", "unit", "meaning"), rows, numbers=(1,), kind="readouts"
            )
    return f"<h2>Read-outs</h2>{text}" if text else ""


def _nodes(facts: dict[str, Any]) -> str:
    rows = []
    for name, node in facts["nodes"].items():
        values = [
            f"{each} = {number(node['parameters'][each]['value'])}"
            + (f" {node['parameters'][each]['unit']}" if node["parameters"][each]["unit"] else "")
            for each in node["set"]
        ]
        said = state(facts["skipped"].get(name, []))
        rows.append(
            (name, node["title"], ", ".join(values), said, f"{1e3 * node['seconds']:.1f} ms")
        )
    seconds = facts["run"]["seconds"]
    return (
        "<h2>Nodes</h2>"
        + table(("node", "module", "set", "", "time"), rows, numbers=(4,))
        + "<p>Parameters not listed have their defaults. A node that only "
        "multiplies the spectrum takes no time of its own: the product is applied where the "
        f"picture is made. Input pictures {seconds['sources']:.3f} s, evaluation "
        f"{seconds['evaluation']:.3f} s, {seconds['total']:.3f} s in all before this report.</p>"
    )
