"""The window answers within 50 ms, whatever the worker computes meanwhile."""

import itertools
import time

import pytest

from app.editor.evaluation.drag_measure import measure_drag
from app.editor.evaluation.evaluator import Evaluator
from app.editor.measures.slider_drag import measured, open_slider
from app.editor.session import Session
from core.editing.document import Document
from core.editing.fields import SetParameter
from editor_wants import Asking, Readouts, Samples

GAP_S = 0.050
DRAG_S = 2.5
TRIES = 4

# What is dragged, and between which values: an MTF, the noise, the pupil, and the scene itself.
DRAGS = [
    ("aberration", "sigma_x_mrad", 0.05, 0.5),
    ("electronics", "amplifier_snr", 50.0, 150.0),
    ("optics", "size_x_cm", 10.0, 14.0),
    ("scene", "temperature_K", 285.0, 300.0),
]


@pytest.fixture
def evaluator(session):
    made = Evaluator(session)
    yield made
    made.close()
    made.deleteLater()


@pytest.fixture
def idle_gap(qtbot, library):
    """The longest gap of the same loop and edits with nobody computing: what the machine does."""
    alone = Session(library)

    def longest(network, drag):
        alone.open(Document(network, library=library))
        return measure_drag(alone, None, edits(*drag), seconds=1.0).longest_gap

    yield longest
    alone.deleteLater()


def edits(node, name, low, high):
    values = (low + (high - low) * (step % 250) / 250 for step in itertools.count())
    return (SetParameter(node, name, value) for value in values)


def stays_short(longest, alone):
    """Whether the longest gap stays below the limit in one of some tries.

    A gap of ours comes again, one of the machine need not; what it does `alone`, with nobody
    computing, is not held against us.
    """
    gaps, idle = [], []
    for _ in range(TRIES):
        gaps.append(round(longest(), 3))
        if gaps[-1] < GAP_S:
            return
        idle.append(alone())
    if min(idle) > GAP_S:
        pytest.skip(f"this machine stops the loop for {min(idle):.3f} s with nobody computing")
    pytest.fail(f"the event loop stood still for {gaps} s")


@pytest.mark.parametrize("drag", DRAGS, ids=lambda drag: f"{drag[0]}.{drag[1]}")
def test_the_loop_goes_on_while_a_chain_of_1024_computes(opened, evaluator, qtbot, idle_gap, drag):
    session = opened("kodak_kir310")
    network = session.network
    assert network.nodes["scene"].params["width"] == 1024
    evaluator.ask("viewer", [Samples("frame_grabber.image")])
    evaluator.ask("panel", [Readouts("electronics")])
    qtbot.waitUntil(lambda: evaluator.idle, timeout=60_000)

    def longest():
        measured = measure_drag(session, evaluator, edits(*drag), seconds=DRAG_S)
        qtbot.waitUntil(lambda: evaluator.idle, timeout=60_000)
        assert len(measured.gaps) > DRAG_S / GAP_S
        assert measured.full or measured.previews
        return measured.longest_gap

    stays_short(longest, lambda: idle_gap(network, drag))


# The sizes of pictures, and the slider that is dragged.
WINDOWS = [
    (1024, "aberration", "sigma_x_mrad"),
    (512, "aberration", "sigma_x_mrad"),
    (512, "electronics", "amplifier_snr"),
    (512, "optics", "size_x_cm"),
]


@pytest.mark.parametrize("drag", WINDOWS, ids=lambda drag: f"{drag[0]}-{drag[1]}.{drag[2]}")
def test_the_whole_window_goes_on_while_a_slider_is_dragged(window, idle_gap, drag):
    """All of it, painted: canvas, panel with its illustration, viewers, curves, figures."""
    size, node, parameter = drag
    window.resize(1600, 900)

    def longest():
        slider = open_slider(window, size, node, parameter)  # anew: nothing is known already
        seen = measured(window, slider, DRAG_S)
        assert seen["pictures"] > 0
        return seen["largest_gap_ms"] / 1000

    alike = next(each for each in DRAGS if each[0] == node)
    stays_short(longest, lambda: idle_gap(window.session.network, alike))


def test_a_view_that_is_slow_to_draw_is_noticed(window):
    """What the test above is to find."""
    window.resize(1600, 900)
    slider = open_slider(window, 512)
    window.evaluator.answered.connect(slow_to_draw)
    assert measured(window, slider, 1.0)["gaps_over_50_ms"] > 0


def slow_to_draw(answer):
    if answer.owner == "plot_viewer":
        time.sleep(1.2 * GAP_S)


def test_a_worker_that_keeps_python_to_itself_is_noticed(opened, evaluator, qtbot):
    """Builtins in C never let another thread run: what the test above is to find."""
    session = opened("kodak_kir310")
    evaluator.ask("viewer", [Asking(lambda _: sum(range(10_000_000)))])
    qtbot.waitUntil(lambda: evaluator.idle, timeout=60_000)
    measured = measure_drag(session, evaluator, edits(*DRAGS[1]), seconds=1.0)
    assert measured.longest_gap == max(measured.gaps) > GAP_S
    pictures = len(measured.full) + len(measured.previews)
    assert measured.pictures_per_second == pictures / measured.seconds
