"""The budget of noise and blur: which stage contributes how much, as bars and as tables."""

from __future__ import annotations

from typing import Any

from app.report.drawing import COLOURS, figure
from app.report.markup import figure as shown
from app.report.markup import table
from app.report.numbers import number

Fact = dict[str, Any]
_ACROSS, _ALONG = COLOURS[0], COLOURS[1]


def budget(facts: dict[str, Any]) -> str:
    """The section; empty without noise and blur."""
    noise, blur = facts["budget"]["noise"], facts["budget"]["blur"]
    if noise is None and blur is None:
        return ""
    caption = " ".join(
        [
            *(["Noise: share of the sum of variances in the final picture."] if noise else []),
            *(["Blur: share of −ln MTF at half the Nyquist frequency."] if blur else []),
        ]
    )
    text = "<h2>What contributes how much</h2>"
    text += shown(bars_png(noise, blur), caption, "shares of noise and blur")
    return text + (_noise(noise) if noise else "") + (_blur(blur) if blur else "")


def bars_png(noise: Fact | None, blur: Fact | None) -> bytes:
    """A bar for each noise, and two for each stage's blur: across and along."""
    counts = [len(noise["sources"]) if noise else 0, len(blur["stages"]) if blur else 0]
    panels = sum(count > 0 for count in counts)
    with figure(10.0 if panels == 2 else 6.6, 1.0 + 0.42 * max(counts)) as (drawn, out):
        axes = list(drawn.subplots(1, panels, squeeze=False)[0])
        if noise:
            axis = axes.pop(0)
            shares = [100.0 * each["share"] for each in noise["sources"]]
            names = _distinct([_name(each) for each in noise["sources"]], noise["sources"])
            _bars(axis, names, [(shares, "#6d8fb3", "")])
            axis.set_title("Noise")
            axis.set_xlabel("share of the variance (%)")
        if blur:
            axis = axes.pop(0)
            across, along = (
                [100.0 * each[f"share_{name}"] for each in blur["stages"]] for name in ("x", "y")
            )
            names = _distinct([each["title"] for each in blur["stages"]], blur["stages"])
            _bars(axis, names, [(across, _ACROSS, "across"), (along, _ALONG, "along")])
            axis.set_title("Blur")
            axis.set_xlabel("share of −ln MTF (%)")
            drawn.legend(loc="outside lower right", ncols=2, fontsize=8.5)
    return out.getvalue()


def _bars(axis: Any, names: list[str], series: list[tuple[list[float], str, str]]) -> None:
    """Horizontal bars with their values, the first name on top."""
    height = 0.7 / len(series)
    values = [value for shares, _, _ in series for value in shares]
    for place, (shares, colour, label) in enumerate(series):
        middle = [row + (place - (len(series) - 1) / 2) * height for row in range(len(names))]
        bars = axis.barh(middle, shares, height, color=colour, label=label or None)
        texts = [_percent(share / 100.0) for share in shares]
        axis.bar_label(bars, texts, padding=3, fontsize=7.5)
    axis.set_yticks(range(len(names)), names)
    axis.invert_yaxis()
    axis.grid(visible=False, axis="y")
    axis.set_axisbelow(True)
    # Room for the values beside the longest bars.
    low, high = min(0.0, *values), max(1.0, *values)
    room = 0.15 * (high - low)
    axis.set_xlim(low - room if low < 0.0 else 0.0, high + room)


def _percent(share: float) -> str:
    """A share in percent; what is next to nothing says so instead of its digits."""
    if share != 0.0 and abs(share) < 5e-4:
        return "<0.05" if share > 0.0 else ">\u22120.05"
    return number(float(format(100.0 * share, ".3g")))


def _name(source: Fact) -> str:
    return source["name"].capitalize() if source["name"] else str(source["title"])


def _distinct(names: list[str], rows: list[Fact]) -> list[str]:
    """Names for the bars, with their node where two are alike."""
    return [
        f"{name} ({row['node']})" if names.count(name) > 1 else name
        for name, row in zip(names, rows, strict=True)
    ]


def _noise(noise: Fact) -> str:
    rows = [
        (
            _name(each),
            each["node"],
            number(each["sigma"]),
            number(each["mean"]),
            _percent(each["share"]),
        )
        for each in noise["sources"]
    ]
    rows += [
        ("Root of the sum of variances", "", number(noise["summed"]), "", ""),
        ("All together", "", number(noise["together"]), "", ""),
    ]
    unit = f" ({noise['unit']})" if noise["unit"] else ""
    heads = ("noise", "node", f"σ{unit}", f"mean{unit}", "share (%)")
    told = (
        f"<p>What {noise['port']} loses when a source alone is silenced and all others are drawn "
        "as before. Errors of gain and bias vary from detector to detector, not in time.</p>"
    )
    return "<h3>Noise in the final picture</h3>" + told + table(heads, rows, numbers=(2, 3, 4))


def _blur(blur: Fact) -> str:
    xi, eta = number(blur["xi_cyc_per_mrad"]), number(blur["eta_cyc_per_mrad"])
    rows = [
        (
            each["title"],
            each["node"],
            number(each["mtf_x"]),
            _percent(each["share_x"]),
            number(each["mtf_y"]),
            _percent(each["share_y"]),
        )
        for each in blur["stages"]
    ]
    heads = ("stage", "node", "|MTF| x", "share x (%)", "|MTF| y", "share y (%)")
    told = f"<p>At {xi} cyc/mrad across and {eta} along.</p>"
    return "<h3>Blur of the stages</h3>" + told + table(heads, rows, numbers=(2, 3, 4, 5))
