"""Read-outs and ports on panels, with a real evaluation behind them; and files chosen for them."""

import html
import math

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QPalette
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QFileDialog, QLineEdit, QWidget

from app.editor.evaluation.queries import Answer, Passing
from app.editor.panels.fields.field import PanelNode
from app.editor.panels.module_body import NONE, ReadoutsView
from app.editor.theme import DARK
from app.run.staging import read_record
from core.chain.engine import Engine
from core.editing.document import Document
from core.editing.operations import rewire
from core.errors import DataError
from core.evaluation.work import Policy
from core.modules.declaration import declaration
from core.network.network import Link
from editor_queries import Asking, Gate
from focal_plane_bench import CAMERA_SHEET, focal_plane_bench
from linked_network import linked_network
from nodes.detector.focal_plane import FocalPlane
from panel_hands import LEFT, LIBRARY, NoEvaluator, drop, field_of, panel_area, type_in

WITH_READOUTS = [key for key, module in LIBRARY.items() if declaration(module).readouts]

# A small chain that has something of every type of port.
CHAIN = {
    "scene": ("test_scene", {"width": 64, "height": 64}),
    "init": (
        "init_trans",
        {"detector_x_um": 50.0, "detector_y_um": 50.0, "focal_length_mm": 50.0, "f_number": 2.0},
    ),
    "blur": ("gaussian_mtf", {"sigma_x_mrad": 0.5}),
    "pupil": ("exit_pupil", {}),
    "back": ("back_transform", {}),
    "counted": ("focal_plane", {"integration_time_s": 1e-5, "full_well_e": 4e6}),
}
LINKS = (
    ("scene.image", "init.image"),
    ("init.context", "blur.context"),
    ("init.magnitude", "blur.magnitude"),
    ("blur.magnitude", "back.magnitude"),
    ("init.phase", "back.phase"),
    ("scene.image", "counted.image"),
    ("init.context", "counted.context"),
)
SOURCES = {
    "image": "back.image",
    "context": "init.context",
    "magnitude": "blur.magnitude",
    "phase": "init.phase",
    "pupil": "pupil.pupil",
    "transfer": "blur.mtf",
    "table": "counted.table",
}
PARAMS = {
    "read_window": {"row_time_us": 10.0},
    "charge_diffusion_mtf": {"absorption_per_um": 0.05},
    "read_image": {"path": "picture.npy", "fov_x_deg": 10.0, "fov_y_deg": 10.0},
    "noise_file": {"path": "picture.npy"},
    "camera": {"pixels_x": 64, "pixels_y": 64, "pitch_um": 20.0, "focal_length_mm": 50.0},
    "image_quality": {"range_m": 1000.0},
    "electronics_noise": {
        "cut_on_um": 8.0,
        "cut_off_um": 12.0,
        "bandwidth_Hz": 1000.0,
        "d_star": 1e10,
        "bits": 8,
    },
}


# What a module needs to see to have anything to tell.
SCENES = {"measured_mtf": "slanted_edge"}


def chain_with(key, folder):
    """The chain with one more node, whose inputs all are linked."""
    np.save(folder / "picture.npy", np.arange(64.0 * 64).reshape(64, 64))
    inputs = [(SOURCES[p.types[0]], f"node.{p.name}") for p in declaration(LIBRARY[key]).inputs]
    scene = ("test_scene", {"kind": SCENES.get(key, "dormitory"), "width": 64, "height": 64})
    nodes = {**CHAIN, "scene": scene, "node": (key, PARAMS.get(key, {}))}
    if key == "nuc":  # a correction needs a pattern to correct
        nodes["pattern"] = ("noise_3d_source", {"sigma_vh": 1.0})
        inputs = [("back.image", "pattern.image"), ("pattern.image", "node.image")]
    if key == "reflected_light":  # reflectances
        read = {**PARAMS["read_image"], "scale": 1e-4, "unit": "reflectance"}
        nodes["paint"] = ("read_image", {**read, "cut_on_um": 0.4, "cut_off_um": 0.7})
        inputs = [("paint.image", "node.image")]
    return linked_network(nodes, (*LINKS, *inputs))


def open_chain(session, key, folder):
    network = chain_with(key, folder)
    session.open(Document(network, library=LIBRARY, path=folder / "network.json"))
    session.select(["node"])
    return network


def texts(area):
    return {name: label.text() for name, label in area.panels["node"].body.readouts.values.items()}


# A figure, a text, and none; of pictures, of files, of modules that need a special chain.
READ = ("electronics_noise", "read_image", "measured_mtf", "reflected_light", "camera")


@pytest.mark.thorough(but=4, always=READ)
@pytest.mark.parametrize("key", WITH_READOUTS)
def test_read_outs_appear_where_the_inputs_are_there(qtbot, session, evaluator, tmp_path, key):
    area = panel_area(qtbot, session, evaluator)
    network = open_chain(session, key, tmp_path)
    engine = Engine(LIBRARY)
    wanted = engine.readouts(engine.plan(network, folder=tmp_path), "node", engine.work(Policy()))
    assert set(texts(area)) == set(wanted)
    there = {name for name, value in wanted.items() if value is not None}
    assert there
    qtbot.waitUntil(lambda: all(texts(area)[name] != "—" for name in there))
    for readout in declaration(LIBRARY[key]).readouts:
        text, value = texts(area)[readout.name], wanted[readout.name]
        if value is None:
            assert text == "—"
        elif isinstance(value, str):
            assert text == value
        else:
            assert math.isclose(float(text), value, rel_tol=5e-5)
        label = area.panels["node"].body.readouts.values[readout.name]
        assert readout.meaning in html.unescape(label.toolTip())
        assert label.isVisible()


def test_ports_show_what_is_linked_and_are_viewed(qtbot, session, tmp_path):
    area = panel_area(qtbot, session)
    open_chain(session, "jitter_mtf", tmp_path)
    QApplication.processEvents()
    ports = area.panels["node"].body.ports
    labels = [label.text() for label in ports._inputs.values()]
    assert labels == ["context ← init.context", "magnitude ← blur.magnitude"]
    view = ports.findChild(QWidget, "view.output.mtf")
    with qtbot.waitSignal(area.view_wanted) as asked:
        QTest.mouseClick(view, LEFT, pos=view.rect().center() / 2)
    assert asked.args == ["node", "mtf", 1]
    with qtbot.waitSignal(area.view_wanted) as asked:
        view.menu().actions()[2].trigger()
    assert asked.args == ["node", "mtf", 3]
    brought = ports.findChild(QWidget, "view.input.magnitude")
    with qtbot.waitSignal(area.view_wanted) as asked:
        brought.setFocus()
        QTest.keyClick(brought, Qt.Key.Key_Space)
    assert asked.args == ["blur", "magnitude", 1]
    session.do(rewire(remove=(Link("blur", "magnitude", "node", "magnitude"),)))
    assert ports._inputs["magnitude"].text() == "magnitude ← not connected"
    assert not brought.isEnabled()


def choose(qtbot, field, path):
    """Open the dialog, type a file's name and press Enter."""
    QTest.mouseClick(field.browse, LEFT)
    dialog = field.findChild(QFileDialog)
    qtbot.waitUntil(dialog.isVisible)
    verb = "Open" if dialog.acceptMode() == QFileDialog.AcceptMode.AcceptOpen else "Write"
    assert dialog.windowTitle() == f"{verb} file: node · {field.title}"
    line = dialog.findChild(QLineEdit, "fileNameEdit")
    line.setText(str(path))
    QTest.keyClick(line, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: field.findChild(QFileDialog) is None)


def test_a_file_is_chosen_and_named_from_the_networks_folder(qtbot, session, tmp_path):
    home = tmp_path / "networks"
    (home / "pictures").mkdir(parents=True)
    inside, outside = home / "pictures" / "a.npy", tmp_path / "b.npy"
    for path in (inside, outside):
        np.save(path, np.ones((4, 4)))
    area = panel_area(qtbot, session)
    session.open(Document(linked_network({}), library=LIBRARY, path=home / "n.json"))
    drop(session, "read_image")
    field = field_of(area, session, "path")
    choose(qtbot, field, inside)
    assert session.network.nodes["node"].params["path"] == "pictures/a.npy"
    assert field.edit.text() == "pictures/a.npy"
    choose(qtbot, field, outside)
    assert session.network.nodes["node"].params["path"] == outside.as_posix()


def test_a_file_chosen_to_be_written_is_allowed_to_later_runs(
    qtbot, session, tmp_path, monkeypatch
):
    """Kept in the user's own record, under the file that the network is saved in."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    home, other = tmp_path / "nets" / "n.json", tmp_path / "copies" / "m.json"
    for path in (home, other):
        path.parent.mkdir()
    target = tmp_path / "results.png"
    area = panel_area(qtbot, session)
    session.open(Document(linked_network({}), library=LIBRARY))
    drop(session, "write_image")
    field = field_of(area, session, "path")
    choose(qtbot, field, target)
    assert read_record(home).chosen == frozenset()
    assert session.save(home)
    assert read_record(home).chosen == {target}
    choose(qtbot, field, tmp_path / "more.png")
    assert read_record(home).chosen == {target, tmp_path / "more.png"}
    session.open(Document(session.network, library=LIBRARY, path=home))
    assert session.save(other)
    assert read_record(other).chosen == {target, tmp_path / "more.png"}
    session.open(Document(linked_network({}), library=LIBRARY))
    assert session.save(tmp_path / "nets" / "new.json")
    assert read_record(tmp_path / "nets" / "new.json").chosen == frozenset()


def title_of(area):
    return area.panels["node"].body.readouts.title.text()


def test_read_outs_follow_edits_are_marked_as_old_and_go_where_they_cannot_be(
    qtbot, session, evaluator, tmp_path
):
    area = panel_area(qtbot, session, evaluator)
    open_chain(session, "jitter_mtf", tmp_path)
    qtbot.waitUntil(lambda: texts(area)["half_contrast"] != "—")
    readouts = area.panels["node"].body.readouts
    before, value = texts(area), next(iter(readouts.values.values()))
    assert title_of(area) == "Read-outs"
    # While something else takes the worker's time.
    gate = Gate()
    evaluator.ask("viewer", [Asking(gate, urgency=-1)])
    qtbot.waitUntil(gate.entered.is_set)
    type_in(field_of(area, session, "sigma_mrad").edit, "0.5")
    qtbot.waitUntil(lambda: readouts.is_old)
    assert title_of(area) == "Read-outs: computed before the last edit"
    assert texts(area) == before
    assert value.palette().color(QPalette.ColorRole.Text).name() == DARK.faint_text
    gate.opened.set()
    evaluator.forget("viewer")
    qtbot.waitUntil(lambda: not readouts.is_old)
    # exp(−2(π·0.5·f)²) = 1/2
    expected = math.sqrt(math.log(2) / 2) / (math.pi * 0.5)
    assert float(texts(area)["half_contrast"]) == pytest.approx(expected, rel=1e-4)
    assert title_of(area) == "Read-outs"
    assert value.palette().color(QPalette.ColorRole.Text).name() == DARK.text
    session.do(rewire(remove=(Link("init", "context", "node", "context"),)))
    qtbot.waitUntil(lambda: set(texts(area).values()) == {"—"})
    session.undo()
    qtbot.waitUntil(lambda: texts(area)["half_contrast"] != "—")


def test_the_reason_stands_in_tooltip_and_description(qtbot, session, tmp_path):
    view = ReadoutsView(
        declaration(FocalPlane), PanelNode(session, NoEvaluator(session), "it", None, None), None
    )
    qtbot.addWidget(view)
    netd = view.values["netd_K"]

    def answer(**outcome):
        view.take(Answer(1, view.owner, view.query, **outcome))
        return netd.accessibleDescription(), html.unescape(netd.toolTip())

    def computed(**changed):
        bench = focal_plane_bench(tmp_path, {**CAMERA_SHEET, **changed}, size=(16, 16))
        return view.query.answer(Passing(bench.engine, bench.plan, bench.work, 1))

    said, tip = answer(value=computed(integration_time_s=0.1))
    assert netd.text() == NONE
    assert "of the full well and is clipped" in said
    assert said in tip
    said, tip = answer(value=computed())
    assert netd.text() != NONE
    assert said == ""
    assert "full well" not in tip
    said, tip = answer(error=DataError("it: no picture comes in"))
    assert netd.text() == NONE
    assert "no picture comes in" in said
    assert said in tip
