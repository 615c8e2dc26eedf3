"""The budget of noise and blur: which stage contributes how much, as bars and as tables."""

from __future__ import annotations

from itertools import cycle
from typing import Any

from app.report.blocks import Block, Drawn, Grid, Heading, Text, of_many
from app.report.drawing.picture_drawing import COLOURS, MOST_DRAWN, figure, strongest
from app.report.drawing.printed_numbers import number, short
from nodes.analysis.budget_shares import source_title

Fact = dict[str, Any]
_ACROSS, _ALONG = COLOURS[0], COLOURS[1]
_KINDS = {"temporal": "#6d8fb3", "fixed": "#b8894a"}


def budget(facts: Fact) -> list[Block]:
    """The section, with the reason where there is no noise or no blur."""
    contributions = facts["budget"]
    noise, blur = contributions["noise"], contributions["blur"]
    blocks: list[Block] = [Heading(2, "What contributes how much")]
    if noise or blur:
        caption = " ".join(
            [
                *(["Noise: share of the variance in the final picture."] if noise else []),
                *(["Blur: share of −ln |MTF| at half the Nyquist frequency."] if blur else []),
            ]
        )
        caption += of_many(len(noise["sources"]), "noises") if noise else ""
        caption += of_many(len(blur["stages"])) if blur else ""
        blocks.append(Drawn(bars_png(noise, blur), caption, "shares of noise and blur"))
    blocks += _noise(noise) if noise else _not_shared("Noise", contributions["noise_reason"])
    return blocks + (_blur(blur) if blur else _not_shared("Blur", contributions["blur_reason"]))


def _not_shared(what: str, reason: str) -> list[Block]:
    return [Text(f"{what} is not shared out: {reason}.")]


def bars_png(noise: Fact | None, blur: Fact | None) -> bytes:
    """A bar for each noise, and two for each stage's blur: across and along."""
    sources, stages = noise["sources"] if noise else [], blur["stages"] if blur else []
    sources = [sources[at] for at in strongest([source["share"] for source in sources])]
    sizes = [max(abs(stage["share_x"]), abs(stage["share_y"])) for stage in stages]
    stages = [stages[at] for at in strongest(sizes)]
    counts = [len(sources), len(stages)]
    panels = sum(count > 0 for count in counts)
    with figure(10.0 if panels == 2 else 6.6, 1.3 + 0.42 * max(counts)) as (drawn, out):
        axes = list(drawn.subplots(1, panels, squeeze=False)[0])
        if noise:
            axis = axes.pop(0)
            names = _distinct([_name(source) for source in sources], sources)
            _stacked(axis, names, sources)
            axis.set_title("Noise")
            axis.set_xlabel("share of the variance (%)")
            _legend(axis)
        if blur:
            axis = axes.pop(0)
            across, along = (
                [100.0 * stage[f"share_{name}"] for stage in stages] for name in ("x", "y")
            )
            names = _distinct([stage["title"] for stage in stages], stages)
            _bars(axis, names, [(across, _ACROSS, "across"), (along, _ALONG, "along")])
            axis.set_title("Blur")
            axis.set_xlabel("share of −ln |MTF| (%)")
            _legend(axis)
    return out.getvalue()


def _legend(axis: Any) -> None:
    axis.legend(
        loc="upper center", bbox_to_anchor=(0.5, 0.0), borderaxespad=4.0, ncols=2, fontsize=8.5
    )


def _stacked(axis: Any, names: list[str], sources: list[Fact]) -> None:
    """A horizontal bar for each source, of its temporal noise and its fixed pattern."""
    ends = [0.0] * len(sources)
    for kind, colour in _KINDS.items():
        values = [100.0 * source[f"share_{kind}"] for source in sources]
        if any(source[kind] is not None for source in sources):
            bars = axis.barh(range(len(sources)), values, 0.5, ends, color=colour, label=kind)
            ends = [end + value for end, value in zip(ends, values, strict=True)]
    axis.bar_label(bars, [_percent(source["share"]) for source in sources], padding=3, fontsize=7.5)
    _dress(axis, names, ends)


def _bars(axis: Any, names: list[str], series: list[tuple[list[float], str, str]]) -> None:
    height = 0.7 / len(series)
    for place, (shares, colour, label) in enumerate(series):
        middle = [row + (place - (len(series) - 1) / 2) * height for row in range(len(names))]
        bars = axis.barh(middle, shares, height, color=colour, label=label)
        texts = [_percent(share / 100.0) for share in shares]
        axis.bar_label(bars, texts, padding=3, fontsize=7.5)
    _dress(axis, names, [value for shares, _, _ in series for value in shares])


def _dress(axis: Any, names: list[str], values: list[float]) -> None:
    """Names beside the bars, the first on top, and room for the values behind the longest."""
    axis.set_yticks(range(len(names)), names)
    axis.invert_yaxis()
    axis.grid(visible=False, axis="y")
    axis.set_axisbelow(True)
    low, high = min(0.0, *values), max(1.0, *values)
    room = 0.15 * (high - low)
    axis.set_xlim(low - room if low < 0.0 else 0.0, high + room)


def _percent(share: float) -> str:
    """A share in percent; what rounds to nothing is shown as a bound."""
    if share != 0.0 and abs(share) < 5e-4:
        return "<0.05" if share > 0.0 else ">\u22120.05"
    return number(float(format(100.0 * share, ".3g")))


def _name(source: Fact) -> str:
    return source_title(source["name"])


def _distinct(names: list[str], rows: list[Fact]) -> list[str]:
    """Names for the bars, with their node where two are alike."""
    return [
        f"{name} ({row['node']})" if names.count(name) > 1 else name
        for name, row in zip(names, rows, strict=True)
    ]


def _noise(noise: Fact) -> list[Block]:
    rows = [
        (
            _name(source),
            source["node"],
            number(source["temporal"]),
            number(source["fixed"]),
            _percent(source["share"]),
        )
        for source in noise["sources"]
    ]
    rows.append(
        ("All together", "", number(noise["temporal"]), number(noise["fixed"]), _percent(1.0))
    )
    unit = f" ({noise['unit']})" if noise["unit"] else ""
    heads = ("noise", "node", f"σ temporal{unit}", f"σ fixed{unit}", "share (%)")
    text = (
        f"Predicted for {noise['port']} from the chain, for all sensors of this kind: "
        "temporal noise changes from frame to frame, fixed patterns stay. "
        f"{_beside(noise)}"
    )
    heading = Heading(3, "Noise in the final picture")
    return [heading, Text(text), Grid(heads, rows, numbers=(2, 3, 4))]


def _beside(noise: Fact) -> str:
    """The prediction of all noise, and what this picture has of it."""
    all_noise = f"All noise: σ = {number(noise['summed'])} predicted"
    if noise["together"] is None:
        reason = noise["together_reason"]
        return f"{all_noise}; this picture’s own noise is not known: {reason}."
    unit = f" {noise['unit']}" if noise["unit"] else ""
    return (
        f"{all_noise}, {number(noise['together'])}{unit} simulated in this picture, whose mean "
        f"the noise moves by {number(noise['together_mean'])}{unit}."
    )


def _blur(blur: Fact) -> list[Block]:
    xi, eta = number(blur["xi_cyc_per_mrad"]), number(blur["eta_cyc_per_mrad"])
    rows = [
        (
            stage["title"],
            stage["node"],
            number(stage["mtf_x"]),
            _percent(stage["share_x"]),
            number(stage["mtf_y"]),
            _percent(stage["share_y"]),
        )
        for stage in blur["stages"]
    ]
    rows.append(("All together", "", number(blur["mtf_x"]), "", number(blur["mtf_y"]), ""))
    heads = ("stage", "node", "|MTF| x", "share x (%)", "|MTF| y", "share y (%)")
    text = f"At {xi} cyc/mrad across and {eta} along."
    if blur["behind"] is not None:
        text += f" What {blur['behind']} does is not known as transfer functions: stages behind it "
        text += "alone."
    heading = Heading(3, "Blur of the stages")
    return [heading, Text(text), Grid(heads, rows, numbers=(2, 3, 4, 5))]


# The section on pictures with bands: their mean spectra, under the responses that weight them.

_FEW = 40  # bands up to which every one has a dot


def spectrum(facts: Fact) -> list[Block]:
    """The section; empty where no picture has bands."""
    spectra, responses = facts["spectra"]["means"], facts["spectra"]["responses"]
    if not spectra:
        return []
    caption = "Mean of every band of the pictures, left."
    if responses:
        caption += " Response to every wavelength, right, from 0 to 1."
    drawn = Drawn(
        spectra_png(spectra, responses),
        caption + of_many(len(spectra), "spectra"),
        "mean spectra and responses",
    )
    return [Heading(2, "Spectrum"), drawn, _table(spectra), *_transformed(facts)]


def spectra_png(spectra: list[Fact], responses: list[Fact]) -> bytes:
    """Mean spectra against the left axis, responses against the right one."""
    with figure(9.0, 3.9) as (drawn, out):
        axis = drawn.subplots()
        colours = cycle(COLOURS)
        units = list(dict.fromkeys(one["unit"] for one in spectra))
        for one, colour in zip(spectra[:MOST_DRAWN], colours, strict=False):
            dot = "o" if one["bands"] <= _FEW else None
            label = _ports(one)
            axis.plot(
                one["centres_um"], one["mean"], color=colour, lw=1.6, marker=dot, ms=3, label=label
            )
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
                    one["wavelength_um"],
                    one["values"],
                    color=colour,
                    ls="--",
                    lw=1.6,
                    label=f"{one['name']} of {one['node']}",
                )
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
        rows.append(
            (
                ", ".join(one["ports"]),
                number(one["bands"]),
                f"{short(low)} to {short(high)}",
                short(sum(one["widths_um"]) / one["bands"]),
                short(one["centres_um"][highest]),
                short(one["mean"][highest]),
                one["unit"],
            )
        )
    heads = (
        *("picture", "bands", "from, to (µm)", "mean width (µm)"),
        *("highest at (µm)", "mean there", "unit"),
    )
    return Grid(heads, rows, numbers=(1, 3, 4, 5))


def _transformed(facts: Fact) -> list[Block]:
    rows = [
        (
            ", ".join(one["ports"]),
            f"{one['wavelengths']} of {one['bands']}",
            short(one["bound"]),
        )
        for one in facts["spectra"]["transformed"]
    ]
    if not rows:
        return []
    heads = ("filtered picture", "wavelengths transformed", "changes at most, of the contrast")
    words = (
        "Wavelengths that are not transformed are made of the others, where the optics allow it."
    )
    return [Text(words), Grid(heads, rows, numbers=(1, 2))]
