"""The budget of noise and blur: which stage contributes how much, as facts, bars and tables.

Noise is predicted from the chain; blur is taken at half the Nyquist frequency of the pixels.
"""

from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import numpy as np

from app.report.drawing.picture_drawing import COLOURS, figure, legend_below, number, strongest
from app.report.html_page import Block, Drawn, Grid, Heading, Text, of_many
from app.run.evaluation import Evaluation
from core.chain.wires import Image
from core.errors import Cancelled, DataError, ImagechainError
from core.evaluation.work import Work
from nodes.analysis.lineage import NoiseOf, noise_free, transfer_of
from nodes.analysis.noise_budget import (
    NoiseShare,
    blur_shares,
    noise_shares,
    source_title,
    unknown_before,
)
from nodes.input_output.sample_unit import statistics

Fact = dict[str, Any]
_ACROSS, _ALONG = COLOURS[0], COLOURS[1]
_KINDS = {"temporal": "#6d8fb3", "fixed": "#b8894a"}


def budget_facts(evaluation: Evaluation) -> Fact:
    """Noise and blur by stage; of what there is none, the reason."""
    noise, noise_reason = _tried(lambda: _noise_facts(evaluation))
    blur, blur_reason = _tried(lambda: _blur_facts(evaluation))
    return {"noise_reason": noise_reason, "noise": noise, "blur_reason": blur_reason, "blur": blur}


def _tried(make: Callable[[], Fact]) -> tuple[Fact | None, str | None]:
    """What is made, or why it cannot be: the run itself has not failed."""
    try:
        return make(), None
    except Cancelled:
        raise
    except ImagechainError as error:
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
    predicted = noise_shares(work, work.value(NoiseOf(image)), kind="all")
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
    """All noise of this one picture: its deviation, and what it adds to the mean."""
    clean = work.value(noise_free(image.recipe))
    noise = statistics(np.subtract(work.value(image.recipe), clean), for_each=work.for_each)
    return {"together": noise.sigma, "together_mean": noise.mean}


def _source(evaluation: Evaluation, share: NoiseShare) -> Fact:
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
    blur = blur_shares(work, stages=stages, frequency=half, before=unknown_before(passed))
    if not blur.shares and blur.before is not None:
        raise DataError(f"{blur.before} has no known transfer function")
    if not blur.shares:
        raise DataError(f"every transfer function before {port} is 1")
    return {
        "xi_cyc_per_mrad": blur.frequency[0],
        "eta_cyc_per_mrad": blur.frequency[1],
        "behind": blur.before,
        "mtf_x": blur.mtf[0],
        "mtf_y": blur.mtf[1],
        "stages": [
            {"node": one.node, "title": one.label, **_of_axis(one, 0, "x"), **_of_axis(one, 1, "y")}
            for one in blur.shares
        ],
    }


def _of_axis(share: Any, place: int, axis: str) -> Fact:
    return {f"mtf_{axis}": share.mtf[place], f"share_{axis}": share.share[place]}


def budget(facts: Fact) -> list[Block]:
    """The section, with the reason where there is no noise or no blur."""
    contributions = facts["budget"]
    noise, blur = contributions["noise"], contributions["blur"]
    blocks: list[Block] = [Heading(2, "Contributions to noise and blur")]
    if noise or blur:
        told = ["Noise: share of the variance in the final picture."] if noise else []
        told += ["Blur: share of −ln |MTF| at half the Nyquist frequency."] if blur else []
        caption = " ".join(told)
        caption += of_many(len(noise["sources"]), "noises") if noise else ""
        caption += of_many(len(blur["stages"])) if blur else ""
        blocks.append(Drawn(bars_png(noise, blur), caption, "shares of noise and blur"))
    for what, section, shares in (("Noise", _noise, noise), ("Blur", _blur, blur)):
        reason = contributions[f"{what.lower()}_reason"]
        unknown = Text(f"{what} cannot be split among its sources: {reason}.")
        blocks += section(shares) if shares else [unknown]
    return blocks


def bars_png(noise: Fact | None, blur: Fact | None) -> bytes:
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
            names = _distinct([source_title(source["name"]) for source in sources], sources)
            kinds = [
                ([100.0 * source[f"share_{kind}"] for source in sources], colour, kind)
                for kind, colour in _KINDS.items()
                if any(source[kind] is not None for source in sources)
            ]
            _bars(axis, names, kinds)
            axis.set_title("Noise")
            axis.set_xlabel("share of the variance (%)")
            legend_below(axis, 4.0, 8.5)
        if blur:
            axis = axes.pop(0)
            across = [100.0 * stage["share_x"] for stage in stages]
            along = [100.0 * stage["share_y"] for stage in stages]
            names = _distinct([stage["title"] for stage in stages], stages)
            _bars(axis, names, [(across, _ACROSS, "horizontal"), (along, _ALONG, "vertical")])
            axis.set_title("Blur")
            axis.set_xlabel("share of −ln |MTF| (%)")
            legend_below(axis, 4.0, 8.5)
    return out.getvalue()


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


def _distinct(names: list[str], rows: list[Fact]) -> list[str]:
    """Names for the bars, with their node where two are alike."""
    pairs = zip(names, rows, strict=True)
    return [f"{name} ({row['node']})" if names.count(name) > 1 else name for name, row in pairs]


def _noise(noise: Fact) -> list[Block]:
    together = {"node": "", "temporal": noise["temporal"], "fixed": noise["fixed"], "share": 1.0}
    titles = [*(source_title(source["name"]) for source in noise["sources"]), "All together"]
    rows = [
        (title, one["node"], number(one["temporal"]), number(one["fixed"]), _percent(one["share"]))
        for title, one in zip(titles, [*noise["sources"], together], strict=True)
    ]
    unit = f" ({noise['unit']})" if noise["unit"] else ""
    heads = ("noise", "node", f"σ temporal{unit}", f"σ fixed{unit}", "share (%)")
    text = (
        f"Predicted for {noise['port']} from the chain, averaged over all sensors of the same "
        "design. "
        "Temporal noise changes from frame to frame; fixed patterns stay the same. "
        f"{_beside(noise)}"
    )
    heading = Heading(3, "Noise in the final picture")
    return [heading, Text(text), Grid(heads, rows, numbers=(2, 3, 4))]


def _beside(noise: Fact) -> str:
    all_noise = f"All noise: σ = {number(noise['summed'])} predicted"
    if noise["together"] is None:
        reason = noise["together_reason"]
        return f"{all_noise}; the noise in this picture is not known: {reason}."
    unit = f" {noise['unit']}" if noise["unit"] else ""
    return (
        f"{all_noise}, {number(noise['together'])}{unit} simulated in this picture; the noise "
        f"changes the picture's mean by {number(noise['together_mean'])}{unit}."
    )


def _blur(blur: Fact) -> list[Block]:
    xi, eta = number(blur["xi_cyc_per_mrad"]), number(blur["eta_cyc_per_mrad"])
    rows = [
        (one["title"], one["node"], number(one["mtf_x"]), _percent(one["share_x"]),
         number(one["mtf_y"]), _percent(one["share_y"]))
        for one in blur["stages"]
    ]  # fmt: skip
    rows.append(("All together", "", number(blur["mtf_x"]), "", number(blur["mtf_y"]), ""))
    heads = ("stage", "node", "|MTF| x", "share x (%)", "|MTF| y", "share y (%)")
    text = f"At {xi} cyc/mrad horizontally and {eta} vertically."
    if blur["behind"] is not None:
        text += (
            f" {blur['behind']} has no known transfer function, so only the stages after it are "
            "listed."
        )
    heading = Heading(3, "Blur by stage")
    return [heading, Text(text), Grid(heads, rows, numbers=(2, 3, 4, 5))]
