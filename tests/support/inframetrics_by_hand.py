"""The Inframetrics camera built by hand in a real window, to be run on a display of its own.

    python inframetrics_by_hand.py build FOLDER SCREENSHOTS
    python inframetrics_by_hand.py recover FOLDER SCREENSHOTS

`build` ends by waiting to be killed, with work unsaved; `recover` is the next start after that.
What is to be compared is left in FOLDER.
"""

import json
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from PySide6.QtCore import QPoint
from PySide6.QtWidgets import (
    QAbstractButton,
    QApplication,
    QComboBox,
    QLineEdit,
    QPushButton,
    QWidget,
)

from app.editor.window.main_window import MainWindow
from app.editor.window.recent_files import Settings
from app.editor.window.start import application
from app.run.shipped import shipped_networks
from core.modules.declaration import declaration
from core.network.file import load_network
from core.network.network import Link, Network
from hands import Hands, centre, process_events, wait_still, wait_until
from nodes.library import standard_library
from screen_places import place_of_head, place_of_module, place_of_port, place_of_wire


class ValuesByHand:
    """What a builder does on the panels; it brings window, hands, library and what is wanted."""

    def set_values(self):
        for node in self.wanted.nodes.values():
            if node.params:
                self.select(node.id)
                for name, value in node.params.items():
                    self.set_value(node, name, value)
        self.select("electronics")
        self.settle()
        self.screenshot("4_values")

    def set_value(self, node, name, value):
        # Badges that change while all is computed anew may move what stands below them.
        wait_until(lambda: self.window.evaluator.idle, "all is computed")
        field = self.find(QWidget, f"field.{name}", self.window.panels)
        self.turn_to_page_of(field)
        self.bring_into_view(field)
        kind = declaration(self.library[node.module]).parameter(name).kind
        if kind == "choice":
            self.choose(field, name, value)
        elif kind == "switch":
            if self.network.nodes[node.id].params.get(name, False) != value:
                box = self.find(QAbstractButton, f"value.{name}", field)
                self.hands.click(box.mapToGlobal(QPoint(8, box.height() // 2)))
        else:
            self.hands.click(centre(self.find(QLineEdit, f"value.{name}", field)))
            self.hands.enter(repr(value))
        wait_until(
            lambda: (
                self.network.nodes[node.id].params.get(name, _default(self, node, name)) == value
            ),
            f"{node.id}.{name} = {value}",
        )

    def turn_to_page_of(self, field):
        """Press the buttons of the panel's pages until the field is there."""
        pages = self.window.panels.findChild(QWidget, "pages")
        for button in pages.findChildren(QAbstractButton) if pages is not None else ():
            if field.isVisible():
                return
            if button.isVisible():
                self.bring_into_view(button)
                self.hands.click(centre(button))
        assert field.isVisible(), f"{field.objectName()} is on no page"

    def choose(self, field, name, value):
        buttons = [b for b in field.findChildren(QAbstractButton) if b.text() == str(value)]
        if buttons:
            self.bring_into_view(buttons[0])
            self.hands.click(buttons[0].mapToGlobal(QPoint(8, buttons[0].height() // 2)))
            return
        box = self.find(QComboBox, f"value.{name}", field)
        self.hands.click(centre(box))
        self.hands.type(str(value))
        self.hands.keys("Return")

    def bring_into_view(self, widget):
        """Turn the wheel until the widget can be seen."""
        wait_still(widget)
        area = self.window.panels
        for _ in range(60):
            top = widget.mapTo(area.viewport(), QPoint(0, 0)).y()
            if top < 0:
                clicks = 1
            elif top + widget.height() > area.viewport().height():
                clicks = -1
            else:
                return
            # At the right edge, where no slider or list takes the wheel.
            edge = area.viewport().mapToGlobal(
                QPoint(area.viewport().width() - 3, area.viewport().height() // 2)
            )
            self.hands.wheel(edge, clicks)
            wait_still(widget)
        raise AssertionError(f"{widget.objectName()} cannot be scrolled into view")

    def set_seed(self):
        self.deselect()
        for name, value in (("name", self.wanted.name), ("seed", str(self.wanted.seed))):
            edit = self.find(QLineEdit, f"network_{name}", self.window.panels)
            self.hands.click(centre(edit))
            self.hands.enter(value)
        wait_until(lambda: self.network.seed == self.wanted.seed, "the seed is set")


def _default(builder, node, name):
    return declaration(builder.library[node.module]).parameter(name).default


# Of the shipped network a part that has every kind of node, wire, field and page.
KEPT = {
    "scene": ("width",),
    "init": ("detector_x_um", "detector_y_um", "f_number", "focal_length_mm", "platform"),
    "detector": (),
    "jitter": ("sigma_mrad",),
    "back": (),
    "electronics": ("material", "region", "scan_mirror_rate_Hz", "use_mtf"),
    "frame_grabber": (),
}
WIRES = (
    "scene.image init.image, init.context jitter.context, init.magnitude jitter.magnitude, "
    "init.context detector.context, jitter.magnitude detector.magnitude, init.phase back.phase, "
    "detector.magnitude back.magnitude, init.context electronics.context, "
    "back.image electronics.image, electronics.image frame_grabber.image"
)
SIDE = 128
COLUMNS = 4
INSERTED = "jitter"  # dropped on the wire from `init` to `detector`
DROPPED_WIRE = ("electronics", "image", "frame_grabber", "image")  # its target added by its menu


def wanted_network(library):
    """What is built: that part, on a smaller scene."""
    shipped = load_network(shipped_networks()["inframetrics"], library=library)
    nodes = {}
    for name, params in KEPT.items():
        node = shipped.nodes[name]
        sides = {side: SIDE for side in ("width", "height") if side in params}
        nodes[name] = replace(node, params={p: node.params[p] for p in params} | sides)
    links = tuple(Link.between(*wire.split()) for wire in WIRES.split(", "))
    return Network(nodes=nodes, links=links, name=shipped.name, seed=shipped.seed)


class Builder(ValuesByHand):
    """Builds the network as a person would, with nothing but mouse and keys."""

    def __init__(self, folder, screenshots):
        self.folder, self.screenshots = Path(folder), Path(screenshots)
        self.hands = Hands()
        self.library = standard_library()
        self.wanted = wanted_network(self.library)
        self.app = application()
        self.window = MainWindow(
            library=self.library,
            settings=Settings(self.folder / "settings.ini"),
            recovery=self.folder / "recovery",
            remembered=False,
        )
        screen = self.app.primaryScreen().availableGeometry()
        self.window.resize(screen.size())
        self.window.move(0, 0)
        self.window.show()
        self.window.activateWindow()
        wait_until(self.window.isActiveWindow, "the window has the focus")

    @property
    def network(self):
        return self.window.session.network

    @property
    def canvas(self):
        return self.window.canvas

    def screenshot(self, name):
        process_events(0.1)
        picture = self.app.primaryScreen().grabWindow(0)
        assert picture.save(str(self.screenshots / f"{name}.png"))

    def settle(self):
        process_events(0.1)
        wait_until(lambda: self.window.evaluator.idle, "all is computed")
        process_events(0.1)

    def find(self, kind, name, inside=None):
        found = (inside or self.window).findChild(kind, name)
        assert found is not None, f"no {kind.__name__} is called {name}"
        return found

    # --- nodes -------------------------------------------------------------------------------

    def begin(self):
        self.screenshot("1_welcome")
        self.hands.click(centre(self.find(QPushButton, "welcome.new")))
        wait_until(self.canvas.isVisible, "the canvas is there")

    def cell(self, number):
        """Points of the canvas in a grid, on the screen."""
        corner = self.canvas.mapToGlobal(QPoint(0, 0))
        rows = -(-len(self.wanted.nodes) // COLUMNS)
        x = corner.x() + (number % COLUMNS + 0.08) * self.canvas.width() / COLUMNS
        y = corner.y() + (number // COLUMNS + 0.08) * self.canvas.height() / rows
        return QPoint(round(x), round(y))

    def add_nodes(self):
        skipped = DROPPED_WIRE[2]
        for number, node in enumerate(self.wanted.nodes.values()):
            if node.id != skipped:
                self.add(node, self.cell(number), by=("drag", "search", "double-click")[number % 3])
        self.screenshot("2_nodes")

    def add(self, node, point, by):
        before = set(self.network.nodes)
        title = declaration(self.library[node.module]).title
        if by == "drag":
            self.hands.drag(place_of_module(self.window.library_view, node.module), point)
        else:
            if by == "search":
                self.hands.click(point)
                self.hands.keys("Tab")
            else:
                self.hands.double_click(point)
            self.wait_for_popup()
            self.hands.type(title)
            self.hands.keys("Return")
        wait_until(lambda: set(self.network.nodes) - before, f"{title} was added by {by}")
        (name,) = set(self.network.nodes) - before
        self.rename(name, node.id)

    def wait_for_popup(self):
        wait_until(
            lambda: (
                self.canvas.popup.is_open
                and QApplication.focusWidget().objectName() == "canvas.popup.field"
            ),
            "the list of modules takes what is typed",
        )

    def rename(self, old, new):
        if old == new:
            return
        self.select(old)
        self.hands.enter(new, "F2")
        wait_until(lambda: new in self.network.nodes, f"{old} is called {new}")

    def select(self, name):
        self.hands.click(place_of_head(self.canvas, name))
        wait_until(lambda: self.window.session.selection == (name,), f"{name} is selected")

    def deselect(self):
        self.hands.click(self.canvas.mapToGlobal(QPoint(6, self.canvas.height() - 6)))
        wait_until(lambda: not self.window.session.selection, "nothing is selected")

    # --- wires -------------------------------------------------------------------------------

    def port(self, node, port, side):
        return place_of_port(self.canvas, node, port, side)

    def wire(self):
        by_menu = [link for link in self.wanted.links if _ends(link) == DROPPED_WIRE]
        inserted = [link for link in self.wanted.links if INSERTED in (link.source, link.target)]
        for link in self.wanted.links:
            if link not in by_menu + inserted and DROPPED_WIRE[2] not in (link.source, link.target):
                self.connect(*_ends(link))
        self.connect("init", "magnitude", "detector", "magnitude")
        self.drop_on_wire(INSERTED)
        self.wire_to_menu()
        for link in self.wanted.links:
            if link not in self.network.links:
                self.connect(*_ends(link))
        self.deselect()
        self.hands.keys("f")
        self.screenshot("3_wired")

    def connect(self, source, output, target, into):
        self.hands.drag(self.port(source, output, "output"), self.port(target, into, "input"))
        wait_until(
            lambda: (source, output, target, into) in map(_ends, self.network.links),
            f"{source}.{output} is wired to {target}.{into}",
        )

    def refuse(self):
        """A wire of the wrong type is refused, with the reason."""
        before = self.network
        self.hands.drag(
            self.port("scene", "image", "output"), self.port("detector", "magnitude", "input")
        )
        wait_until(lambda: self.window.status.said("error"), "it is refused")
        assert self.network is before
        assert "image" in self.window.status.said("error")
        assert "magnitude" in self.window.status.said("error")

    def drop_on_wire(self, name):
        link = Link("init", "magnitude", "detector", "magnitude")
        head = place_of_head(self.canvas, name)
        self.hands.drag(head, place_of_wire(self.canvas, link), hold=0.1)
        wait_until(
            lambda: len(self.network.links_into(name)) == 2, "the wire runs through the node"
        )

    def wire_to_menu(self):
        source, output, target, _ = DROPPED_WIRE
        before = set(self.network.nodes)
        place = list(self.wanted.nodes).index(target)
        self.hands.drag(self.port(source, output, "output"), self.cell(place))
        self.wait_for_popup()
        self.hands.type(declaration(self.library[self.wanted.nodes[target].module]).title)
        self.hands.keys("Return")
        wait_until(lambda: set(self.network.nodes) - before, f"{target} was added")
        (name,) = set(self.network.nodes) - before
        self.rename(name, target)

    # --- looking, saving, undoing ------------------------------------------------------------

    def look(self):
        self.select("frame_grabber")
        self.hands.keys("1")
        self.settle()
        viewer = self.window.viewers.images[1]
        assert viewer.choices.port == "frame_grabber.image"
        np.save(self.folder / "shown.npy", viewer.picture.samples)
        strip = self.window.figures
        told = {name: strip.label(name).toolTip() for name in strip._names}
        (self.folder / "figures.json").write_text(json.dumps(told))
        self.select("electronics")
        self.settle()
        self.screenshot("5_picture")

    def save(self):
        path = self.folder / "by_hand.json"
        self.hands.keys("ctrl+s")
        wait_until(lambda: self.window.findChild(QWidget, "file_dialog"), "the dialog is open")
        process_events(0.3)
        self.hands.enter(str(path))
        wait_until(path.is_file, "the file is written")
        wait_until(lambda: not self.window.session.document.modified, "the document is saved")

    def undo_all(self):
        full = self.window.session.document.text()
        history = self.window.session.document
        self.deselect()
        steps = history.position
        self.hands.keys(*["ctrl+z"] * steps)
        wait_until(lambda: not history.undo_text, f"{steps} steps are undone")
        assert not self.network.nodes
        assert not self.network.links
        self.screenshot("6_undone")
        self.hands.keys(*["ctrl+shift+z"] * steps)
        wait_until(lambda: not history.redo_text, "all is done again")
        assert self.window.session.document.text() == full
        assert not self.window.session.document.modified

    def work_on_unsaved(self):
        """One more edit, which no file holds; then wait for the end."""
        self.select("jitter")
        self.set_value(self.wanted.nodes["jitter"], "sigma_mrad", 0.5)
        text = self.window.session.document.text()
        (self.folder / "unsaved.json").write_text(text)
        wait_until(lambda: text in self.kept(), "it is kept against a crash")
        (self.folder / "ready").write_text("kill me")
        while True:
            process_events(1.0)

    def kept(self):
        """The networks that recovery files hold, but for one that is being written."""
        files = (self.folder / "recovery").glob("[!.]*.recovery")
        return [json.loads(path.read_text())["network"] for path in files]

    def recover(self):
        self.screenshot("7_recovered_work")
        self.hands.click(centre(self.find(QPushButton, "welcome.recover")))
        wait_until(lambda: self.network.nodes, "the work is there again")
        (self.folder / "recovered.json").write_text(self.window.session.document.text())
        assert self.window.session.document.modified
        self.settle()
        self.screenshot("8_recovered")
        self.window.close_for_good()


def _ends(link):
    return link.source, link.output, link.target, link.input


def main():
    what, folder, screenshots = sys.argv[1:]
    builder = Builder(folder, screenshots)
    start = time.monotonic()
    if what == "recover":
        builder.recover()
        return
    for step in ("begin", "add_nodes", "wire", "refuse", "set_values", "set_seed", "look", "save"):
        try:
            getattr(builder, step)()
        except AssertionError:
            builder.screenshot(f"failed_{step}")
            raise
        print(f"{time.monotonic() - start:.0f} s: {step}", flush=True)
    builder.undo_all()
    print(f"{time.monotonic() - start:.0f} s: undo_all", flush=True)
    builder.work_on_unsaved()


if __name__ == "__main__":
    assert QApplication.instance() is None
    main()
