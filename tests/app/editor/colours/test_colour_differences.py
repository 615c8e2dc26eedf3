"""Wires and curves differ in colour for everyone: usual sight, and one kind of cone missing."""

from itertools import combinations

import pytest
from PySide6.QtGui import QColor

from app.editor.canvas.canvas import Canvas
from app.editor.session import Level
from app.editor.theme import DARK, LIGHT
from app.editor.viewers.plot.plot_looks import entry_pens
from app.editor.viewers.plot.plotted_lines import Entry
from canvas_networks import chain_and_free_blur
from colour_sight import SIGHTS, ciede2000, contrast, difference, lab
from core.editing.document import Document
from panel_hands import NoEvaluator

LEAST = 10.0  # ΔE of CIEDE2000 between any two
THEMES = pytest.mark.parametrize("theme", [DARK, LIGHT], ids=["dark", "light"])

SHARMA = [  # pairs 1, 4, 7, 9, 17, 25 and 34 of Sharma, Wu, Dalal 2005, table 1
    ((50.0, 2.6772, -79.7751), (50.0, 0.0, -82.7485), 2.0425),
    ((50.0, -1.3802, -84.2814), (50.0, 0.0, -82.7485), 1.0000),
    ((50.0, 0.0, 0.0), (50.0, -1.0, 2.0), 2.3669),
    ((50.0, 2.4900, -0.0010), (50.0, -2.4900, 0.0009), 7.1792),
    ((50.0, 2.5, 0.0), (73.0, 25.0, -18.0), 27.1492),
    ((60.2574, -34.0099, 36.2677), (60.4626, -34.1751, 39.4387), 1.2644),
    ((2.0776, 0.0795, -1.1350), (0.9033, -0.0636, -0.5514), 0.9082),
]


def test_the_measure_gives_the_published_differences():
    for one, other, published in SHARMA:
        assert ciede2000(one, other) == pytest.approx(published, abs=5e-5)
        assert ciede2000(other, one) == pytest.approx(published, abs=5e-5)


def test_the_simulation_leaves_greys_and_brings_confused_colours_together():
    for sight in SIGHTS:
        for grey in ("#000000", "#808080", "#ffffff"):
            assert difference(grey, grey, sight) == 0
            assert ciede2000(lab(grey, sight), lab(grey)) < 0.1
    red, green = "#c04030", "#7a7a10"  # told apart by the red and green cones alone
    assert difference(red, green, "deutan") < 0.4 * difference(red, green)
    assert difference(red, green, "tritan") > 0.5 * difference(red, green)
    blue, green = "#3090d0", "#30a890"  # by the blue ones
    assert difference(blue, green, "tritan") < 0.4 * difference(blue, green)


def test_contrast_has_its_ends_and_the_well_known_grey():
    assert contrast("#ffffff", "#000000") == pytest.approx(21.0)
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.005)


@THEMES
@pytest.mark.parametrize("sight", SIGHTS)
def test_types_of_ports_and_the_first_eight_curves_differ(theme, sight):
    entries = [Entry(str(number), f"curve {number}") for number in range(8)]
    curves = [pen.color().name() for pen in entry_pens(entries, theme).values()]
    assert len(set(curves)) == 8
    for colours in (list(theme.ports.values()), curves):
        for one, other in combinations(colours, 2):
            seen = difference(one, other, sight)
            assert seen >= LEAST, (one, other, seen)
    # Magnitude and phase run side by side and differ most.
    assert difference(theme.ports["magnitude"], theme.ports["phase"], sight) >= 12


@THEMES
def test_wires_and_curves_stand_out_from_their_grounds(theme):
    """3 to 1 is what WCAG wants of graphics."""
    for colour in (*theme.ports.values(), *theme.curves):
        for ground in (theme.canvas, theme.node, theme.base):
            assert contrast(colour, ground) >= 3, (colour, ground)


def painted(widget, wanted):
    """Whether dots of that very colour are on a widget."""
    image = widget.grab().toImage()
    dot = QColor(wanted).rgb()
    return any(
        image.pixel(x, y) == dot for x in range(image.width()) for y in range(image.height())
    )


@THEMES
def test_painted_wires_have_these_colours(session, library, qtbot, theme):
    session.open(Document(chain_and_free_blur(), library=library))
    canvas = Canvas(Level(session, session), NoEvaluator(session))
    canvas.setPalette(theme.palette())
    qtbot.addWidget(canvas)
    canvas.resize(1400, 500)
    canvas.show()
    qtbot.waitExposed(canvas)
    canvas.frame_all()
    canvas.zoom_by(1.4)
    assert not painted(canvas, theme.ports["pupil"])  # no port here has or takes one
    wires = canvas.content.wires
    assert {link.output for link in wires} == {"image", "magnitude", "phase"}
    for link, wire in wires.items():
        wire.set_state(hovered=True)  # thick: dots without the ground mixed in
        assert painted(canvas, theme.ports[link.output])
