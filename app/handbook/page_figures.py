"""Drawings that a page of Markdown names in a block of `figure`.

network mwir_camera            a shipped network, to be run
set scene.width=320            a change of it, as --set has it
picture scene.image the scene  a picture of a port, with its caption
curve slices.curve the MTFs    curves of a port
edges pixels.image what is used the edges of a port's picture, as a measurement draws them
mtf pixels.image its MTF        and their MTF
shipped thumbnail_pupils.png   a picture that comes along, with its caption
"""

from __future__ import annotations

import base64
import html
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.handbook.example_figures import curves, picture
from app.handbook.module_examples import SHIPPED
from app.options.option_values import assignment
from app.options.overrides import with_settings
from app.run.shipped import find_network
from core.chain.engine import Engine
from core.chain.wires import Curve, Pupil
from core.errors import UsageError
from core.evaluation.policy import Policy
from core.network.file import load_network


def page_figure(words: str, engine: Engine) -> str:
    """The drawings, side by side, as a piece of a page.

    Parameters
    ----------
    words : str
        A line for every drawing, as the module's docstring lists them.
    engine : Engine
        Of the library.

    Raises
    ------
    UsageError
        For a line that is none of these.
    """
    lines = [line.split(maxsplit=2) for line in words.splitlines() if line.strip()]
    named = [line[1] for line in lines if line[0] == "network"]
    settings = [
        assignment("set", line[1], "NODE.PARAM=VALUE") for line in lines if line[0] == "set"
    ]
    shown = [line for line in lines if line[0] not in ("network", "set")]
    drawings = []
    if named:
        place = find_network(named[0])
        network = load_network(place.path, library=engine.library)
        network = with_settings(network, settings, library=engine.library)
        plan, work = engine.plan(network, folder=place.folder), engine.work(Policy())
    for number, (kind, what, *caption) in enumerate(shown):
        text = caption[0] if caption else what
        if kind == "shipped":
            drawings.append(_shipped(what, text))
        elif kind == "picture":
            samples = engine.value(plan, what, work)
            drawn = np.abs(samples) if isinstance(plan.output(what), Pupil) else samples
            drawings.append(picture(drawn, text))
        elif kind in ("edges", "mtf"):
            samples = engine.value(plan, what, work)
            drawings.append(_measured(samples, kind, text))
        elif kind == "curve" and isinstance(plan.output(what), Curve):
            name = f"{named[0]}-{what}-{number}"
            drawings.append(curves(name, engine.value(plan, what, work), text))
        else:
            raise UsageError(f"a figure of the handbook has the line {kind} {what}")
    return f'<div class="figures">\n{"".join(drawings)}\n</div>\n'


def _shipped(name: str, caption: str) -> str:
    return _png((SHIPPED / "pictures" / name).read_bytes(), caption)


def _measured(samples: NDArray[Any], kind: str, caption: str) -> str:
    """A measurement's drawing of a picture: its edges, or their MTF."""
    # Imported only where a page has one: all that measures.
    from app.measure.measurement_drawing import edges_png, mtf_png
    from app.measure.measuring import Source, measure_pictures
    from app.measure.picture_measurement import MeasuredFile

    picture = np.asarray(samples, np.float64)
    source = Source((MeasuredFile("picture", 1, ""),), [picture], *picture.shape)
    measured = measure_pictures(source)
    if kind == "edges":
        return _png(edges_png(measured, measured.previews[0]), caption, kind)
    return _png(mtf_png(measured), caption, kind)


def _png(content: bytes, caption: str, kind: str = "shipped") -> str:
    data, text = base64.b64encode(content).decode(), html.escape(caption)
    return (
        f'<figure class="{kind}"><img alt="{text}" src="data:image/png;base64,{data}">'
        f"<figcaption>{text}</figcaption></figure>"
    )
