"""The speed of the window: first picture, dragging a slider, large networks, memory."""

import time
from typing import Any

from app.bench.tables import Table, verdict
from app.bench.timing import Settings
from benchmark_processes import figures_of

FIRST_PICTURE_S = 1.5
PICTURES_PER_S = {1024: 45.0, 512: 45.0}
SMALLEST = (512,)
GAP_MS = 30.0
STEP_MS = 50.0  # of a node that is dragged among a hundred
# Sliders beside the blur's: the noise, and the pupil with its drawing.
BLUR = "aberration.sigma_x_mrad"
OTHER_SLIDERS = ("electronics.amplifier_snr", "optics.size_x_cm")
OTHER_SIZE = 512
LOAD_S = 0.5
GROWTH = 0.10
NETWORKS, WARM = 50, 10


def window(settings: Settings) -> list[Table]:
    """Measure each in processes of their own, drawn without a display."""
    rows = [_first_picture(1 if settings.quick else 3)]
    dragged_s = 0.5 if settings.quick else 4.0
    for size in SMALLEST if settings.quick else PICTURES_PER_S:
        rows += _drag(size, dragged_s)
    rows += _large_network()
    number, warm = (2, 1) if settings.quick else (NETWORKS, WARM)
    rows.append(_memory(number, warm))
    heads = {"what": "", "value": "measured", "unit": "", "target": "target", "verdict": ""}
    text = (
        "First picture: from the start of the process until the Kodak network's picture is "
        "painted, the median. Drag: the aberration's slider of that network moved by the mouse 60 "
        "times a second; a picture counts when it is painted; a gap is the longest time "
        "in which the event loop did nothing else. Memory: the most in use in the last round "
        f"through the shipped networks against the first round after {warm}, once the C library "
        "has given back what is free."
    )
    return [Table("editor", "The window", heads, rows, text)]


def _first_picture(times: int) -> dict[str, Any]:
    taken = []
    for _ in range(times):
        start = time.monotonic()
        (figures,) = _measured("first_picture", "kodak_kir310")
        taken.append(figures["picture"] - start)
    value = sorted(taken)[times // 2]
    return _row("first picture of kodak_kir310", value, "s", FIRST_PICTURE_S)


def _drag(size: int, seconds: float) -> list[dict[str, Any]]:
    sliders = (BLUR, *OTHER_SLIDERS) if size == OTHER_SIZE else (BLUR,)
    figures, *others = _measured("slider_drag", str(size), str(seconds), "1", *sliders)
    wanted, shown = PICTURES_PER_S[size], figures["pictures_per_s"]
    return [
        {
            "what": f"slider drag at {size}²",
            "value": shown,
            "unit": "pictures/s",
            "target": f"≥ {wanted:g}",
            "verdict": "met" if shown >= wanted else f"missed: {shown / wanted:.2f} × target",
            **figures,
        },
        _row(f"largest gap of the event loop at {size}²", figures["largest_gap_ms"], "ms", GAP_MS),
        *(
            _row(f"largest gap, {slider} dragged at {size}²", gaps["largest_gap_ms"], "ms", GAP_MS)
            for slider, gaps in zip(sliders[1:], others, strict=True)
        ),
    ]


def _large_network() -> list[dict[str, Any]]:
    (figures,) = _measured("hundred_nodes")
    moving = _row("dragging one of 100 nodes, a step", figures["move_ms"], "ms", STEP_MS)
    return [_row("loading 100 nodes", figures["load_s"], "s", LOAD_S), moving]


def _memory(number: int, warm: int) -> dict[str, Any]:
    (figures,) = _measured("many_networks", str(number), str(warm))
    return _row(f"growth of memory by {number} networks", figures["growth"], "", GROWTH) | figures


def _row(what: str, value: float, unit: str, target: float) -> dict[str, Any]:
    return {
        "what": what,
        "value": value,
        "unit": unit,
        "target": f"≤ {target:g}",
        "verdict": verdict(value, target, None),
    }


def _measured(what: str, *words: str) -> list[dict[str, Any]]:
    return figures_of(what, *words, QT_QPA_PLATFORM="offscreen")


MEASURES = (window,)
