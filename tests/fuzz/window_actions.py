"""What sessions do besides building chains: macros, presets, links, marks, snapshots, history.

Mixed into `window_sessions.WindowSession`. An action that does not fit what stands there is one
that a person would see refused, or does nothing.
"""

from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLineEdit, QMenu, QTabBar

from window_hands import CTRL, KEY, SHIFT

ALT = Qt.KeyboardModifier.AltModifier
UNITS = (
    "600 urad", "3 um", "1 kHz", "2 km", "0.5 mm", "40 %", "300 K", "1e-6 m", "5 µm", "7 bogus",
)  # fmt: skip
NAMES = ("camera", "Lens 2", "it's", "a" * 80, "ümläut", "camera", "x.y", "", "b/c", "π")
FORMULAS = (
    "= {0}", "= 2*{0}", "= {0} + {1}", "= {0}/({1}-{1})", "= nobody.nothing", "= sqrt(-1)", "= 1/0",
    "= round({0})", "= {0}^400", "= ((((", "=", "= 3 um", "= " + "1+" * 600 + "1", "= 'Lens 2'.x",
    "= min({0}, {1}, 3)", "= {0} urad",
)  # fmt: skip
FIELD_ACTIONS = (
    "trade_off", "reset", "unlink", "link", "copy_value", "paste_value", "expose", "hide",
)  # fmt: skip
NODE_ACTIONS = ("copy_values", "paste_values", "save_preset", "mark_output", "connect")
WINDOW_ACTIONS = (
    "keep_snapshot", "flip", "wipe", "go_back", "snapshots", "history", "trade_off", "runs",
    "light", "zoom_in", "zoom_out", "next_part", "previous_part", "generate", "cancel", "welcome",
    "report", "add_run", "shortcuts", "export", "about", "leave_macro", "minimap",
    "thumbnails", "save_as", "open",
)  # fmt: skip


class NewerActions:
    """Actions of a `WindowSession`: macros and what is set, kept, marked and shown beside them."""

    # --- macros ---------------------------------------------------------------------------------

    def do_group(self):
        self.select_some()
        self.hands.focus()
        self.hands.key(KEY.Key_G, CTRL)
        if self.random.random() < 0.5:  # its name is typed at once
            type_text(QApplication.focusWidget(), self.random.choice(NAMES))
            self.hands.key(self.random.choice([KEY.Key_Return, KEY.Key_Escape, KEY.Key_Tab]))

    def do_ungroup(self):
        self.select_macro()
        self.hands.focus()
        self.hands.key(KEY.Key_G, CTRL | SHIFT)

    def do_enter(self):
        """The inside of a macro, by Enter or by a double-click."""
        name = self.select_macro()
        if name is None:
            return
        self.hands.focus()
        if self.random.random() < 0.5:
            self.hands.key(KEY.Key_Return)
        elif self.visible(pos := self.hands.head(name)):
            self.hands.double_click(pos)

    def do_leave(self):
        if self.random.random() < 0.5:
            self.window.canvas.setFocus()
            self.hands.key(KEY.Key_PageUp, ALT)
        elif steps := [one for one in self.window.crumbs.steps if one.isEnabled()]:
            QTest.mouseClick(self.random.choice(steps), Qt.MouseButton.LeftButton)

    def do_rename(self):
        self.hands.focus()
        self.select_some(1)
        self.hands.key(KEY.Key_F2)
        if isinstance(edit := QApplication.focusWidget(), QLineEdit):
            edit.selectAll()
            type_text(edit, self.random.choice(NAMES))
            keys = [KEY.Key_Return, KEY.Key_Tab, KEY.Key_Escape]
            QTest.keyClick(edit, self.random.choice(keys))

    def do_preset(self):
        presets = self.window.shelf.presets
        if len(self.session.network.nodes) < 60:
            self.window.shelf.add(self.random.choice(presets).key, (0.0, 0.0))

    def do_save_preset(self):
        if self.select_macro() is not None:
            self.window.actions_by_name["save_preset"].trigger()

    # --- fields ---------------------------------------------------------------------------------

    def fields(self):
        """The fields of a node's panel that are shown."""
        if (name := self.node()) is None:
            return []
        self.window.level.select([name])
        QApplication.processEvents()
        for tabs in self.window.panels.findChildren(QTabBar):
            if tabs.isVisible() and tabs.count():
                tabs.setCurrentIndex(self.random.randrange(tabs.count()))
        QApplication.processEvents()
        found = self.window.panels.findChildren(QLineEdit)
        return [one for one in found if one.isVisible() and one.objectName().startswith("value.")]

    def do_link(self):
        """Type an expression, or a number in a unit."""
        edits = [edit for edit in self.fields() if edit.isEnabled()]
        if not edits:
            return
        edit = self.random.choice(edits)
        text = self.random.choice(UNITS)
        if self.random.random() < 0.4:
            formula = self.random.choice(FORMULAS)
            text = formula.format(self.place(), self.place())
        elif self.random.random() < 0.7:  # one that most fields may have
            text = f"= min(max({self.place()}, 1), {self.random.randint(1, 9)})"
        edit.setFocus()
        edit.selectAll()
        type_text(edit, text)
        keys = [KEY.Key_Return, KEY.Key_Return, KEY.Key_Tab, KEY.Key_Escape]
        QTest.keyClick(edit, self.random.choice(keys))

    def place(self):
        """`NODE.PARAMETER` of the level shown, as an expression names it."""
        name = self.node()
        declared = self.window.level.declared(name) if name is not None else None
        parameters = declared.parameters if declared is not None else ()
        numbers = [one.name for one in parameters if one.kind in ("number", "integer")]
        if not numbers:
            return "nobody.nothing"
        quoted = name if name.isidentifier() else "'" + name.replace("'", "''") + "'"
        return f"{quoted}.{self.random.choice(numbers)}"

    def do_link_again(self):
        """As often as building."""
        self.do_link()

    def do_set(self):
        """A value that the field may have, most likely: what it has, times two."""
        edits = [edit for edit in self.fields() if edit.isEnabled()]
        if edits:
            edit = self.random.choice(edits)
            edit.setFocus()
            text = edit.text().strip()
            edit.selectAll()
            type_text(edit, f"2*({text})" if self.random.random() < 0.5 else "1")
            QTest.keyClick(edit, KEY.Key_Return)

    def do_field_menu(self):
        """What the menu of a field offers: exposing, hiding, unlinking, the trade-off."""
        if not (edits := self.fields()):
            return
        field = self.random.choice(edits).parentWidget()
        while field is not None and not hasattr(field, "open_menu"):
            field = field.parentWidget()
        if field is None:
            return
        field.open_menu(field.mapToGlobal(QPoint(5, 5)))
        QApplication.processEvents()
        for menu in field.findChildren(QMenu, "field.menu"):
            if self.random.random() < 0.2 and (edit := menu.findChild(QLineEdit, "exposed_name")):
                edit.setText(self.random.choice(NAMES))
                QTest.keyClick(edit, KEY.Key_Return)
                return
            offered = [a for a in menu.actions() if a.isEnabled() and not a.isSeparator()]
            offered = [a for a in offered if a.objectName() in FIELD_ACTIONS]
            if offered:
                action = self.random.choice(offered)
                self.log.append(f"({action.objectName()})")
                menu.close()
                action.trigger()

    def do_sets(self):
        """Keep a panel's values under a name, or take or remove kept ones."""
        if (name := self.node()) is None:
            return
        self.window.level.select([name])
        QApplication.processEvents()
        panel = self.window.panels.panels.get(self.window.level.head + name)
        menu = getattr(panel, "sets_menu", None)
        if menu is None or not panel.head.sets.isVisible():
            return
        menu.aboutToShow.emit()
        sets = [a for a in menu.actions() if a.objectName().startswith("set.")]
        removing = menu.findChild(QMenu, "sets.remove")
        if not sets or self.random.random() < 0.4:
            edit = menu.findChild(QLineEdit, "set_name")
            edit.setText(self.random.choice(NAMES))
            QTest.keyClick(edit, KEY.Key_Return)
        elif removing is not None and self.random.random() < 0.3:
            self.random.choice(removing.actions()).trigger()
        else:
            self.random.choice(sets).trigger()

    def do_values(self):
        """Copy the values of a node, and paste them on others."""
        self.select_some(1)
        self.window.actions_by_name["copy_values"].trigger()
        self.select_some()
        self.window.actions_by_name["paste_values"].trigger()

    # --- marks on the canvas --------------------------------------------------------------------

    def do_dot(self):
        """Bend a wire: by a double-click, by the key, drag the dot, delete it."""
        wires = self.window.canvas.content.wires
        if not wires:
            return
        link = self.random.choice(list(wires))
        pos = self.hands.wire(link)
        if not self.visible(pos):
            return
        way = self.random.randrange(5)
        if way == 0:
            self.hands.double_click(pos)
        elif way == 1:
            self.hands.click(pos)
            self.hands.focus()
            self.hands.key(KEY.Key_R)
        elif dots := wires[link].dots:
            dot = self.window.canvas.view.pixel(self.random.choice(list(dots)))
            if way == 2:
                self.hands.drag(dot, dot + QPoint(self.random.randint(-90, 90), 40))
            else:
                self.hands.click(dot)
                self.hands.focus()
                self.hands.key(self.random.choice([KEY.Key_Delete, KEY.Key_Right]))

    def do_note(self):
        self.hands.focus()
        self.hands.key(KEY.Key_N)
        type_text(QApplication.focusWidget(), self.random.choice(["a note", "", "d l f ß π"]))
        self.hands.key(self.random.choice([KEY.Key_Return, KEY.Key_Escape]))

    def do_distribute(self):
        self.select_some()
        self.hands.focus()
        self.hands.key(self.random.choice([KEY.Key_H, KEY.Key_V]), ALT | SHIFT)

    def do_menu(self):
        """The menu of what is at a point: one of its entries, or a colour."""
        name = self.node()
        pos = self.anywhere()
        if name is not None and self.random.random() < 0.7:
            pos = self.hands.head(name)
        if not self.visible(pos):
            return
        self.hands.ask_for_menu(pos)
        menus = [one for one in self.window.canvas.findChildren(QMenu) if one.isVisible()]
        for menu in menus:
            actions = [one for one in menu.actions() if one.isEnabled() and not one.isSeparator()]
            inner = [one for action in actions if (one := action.menu()) is not None]
            if inner and self.random.random() < 0.5:
                actions = inner[0].actions()
            actions = [one for one in actions if one.menu() is None]
            menu.close()
            if actions:
                action = self.random.choice(actions)
                self.log.append(f"({action.text()})")
                action.trigger()
            return

    def do_cut_wires(self):
        self.hands.drag(self.anywhere(), self.anywhere(), ALT | SHIFT)

    def do_insert(self):
        """A node dropped on a wire."""
        wires, name = self.window.canvas.content.wires, self.node()
        if wires and name is not None:
            head, wire = self.hands.head(name), self.hands.wire(self.random.choice(list(wires)))
            if self.visible(head) and self.visible(wire):
                self.hands.drag(head, wire)

    def do_minimap(self):
        minimap = self.window.canvas.minimap
        if minimap.isVisible():
            pos = QPoint(self.random.randrange(minimap.width()), 5)
            QTest.mouseClick(minimap, Qt.MouseButton.LeftButton, pos=pos)

    # --- states ---------------------------------------------------------------------------------

    def do_history(self):
        """A line of the list of the history."""
        view = self.window.history
        if not view.isVisible():
            self.window.actions_by_name["history"].trigger()
            QApplication.processEvents()
        rows = view.model().rowCount()
        index = view.model().index(self.random.randrange(rows), 0)
        view.setFocus()
        view.setCurrentIndex(index)
        QTest.keyClick(view, KEY.Key_Return)
        if view.isVisible():
            assert self.session.document.position == index.row()

    def do_snapshot(self):
        self.window.actions_by_name["keep_snapshot"].trigger()

    def do_snapshot_list(self):
        """Another A, another name, less of them, or back to one."""
        view = self.window.snapshots_view
        if not view.isVisible():
            self.window.actions_by_name["snapshots"].trigger()
            QApplication.processEvents()
        count = view.list.topLevelItemCount()
        if not count or not view.isVisible():
            return
        view.list.setFocus()
        view.list.setCurrentItem(view.list.topLevelItem(self.random.randrange(count)))
        keys = [KEY.Key_Delete, KEY.Key_Return, KEY.Key_F2, KEY.Key_Up]
        QTest.keyClick(view.list, key := self.random.choice(keys))
        if key == KEY.Key_F2 and isinstance(edit := QApplication.focusWidget(), QLineEdit):
            type_text(edit, self.random.choice(NAMES))
            QTest.keyClick(edit, self.random.choice([KEY.Key_Return, KEY.Key_Escape]))

    # --- the window -----------------------------------------------------------------------------

    def do_full_screen(self):
        """F11, keys there, and back by F11, Esc or the window manager."""
        self.window.actions_by_name["full_screen"].trigger()
        QApplication.processEvents()
        page = self.window.full_screen.page
        if page is None:
            return
        for _ in range(self.random.randrange(4)):
            focus = QApplication.focusWidget() or page
            letters = [KEY.Key_K, KEY.Key_W, KEY.Key_F, KEY.Key_R, KEY.Key_1, KEY.Key_Left]
            QTest.keyClick(focus, self.random.choice(letters))
            if self.random.random() < 0.3:
                self.session.undo()
            QApplication.processEvents()
        way = self.random.randrange(4)
        if way == 0:
            QTest.keyClick(page, KEY.Key_F11)
        elif way == 1:
            QTest.keyClick(page, KEY.Key_Escape)
        elif way == 2:
            page.close()
        else:
            self.do_layout()

    def do_window_action(self):
        name = self.random.choice(WINDOW_ACTIONS)
        self.log.append(f"({name})")
        self.window.actions_by_name[name].trigger()
        QApplication.processEvents()
        if name == "welcome":
            self.window.show_canvas()

    def do_node_action(self):
        self.select_some(1)
        name = self.random.choice(NODE_ACTIONS)
        self.log.append(f"({name})")
        self.window.actions_by_name[name].trigger()
        QApplication.processEvents()
        if name == "connect" and self.window.canvas.popup.is_open:
            for _ in range(2):
                self.hands.key(KEY.Key_Return)

    def do_run(self):
        """Queue a run, or cancel what is queued: few, they are processes of their own."""
        queue = self.window.runs.queue
        if queue.unfinished:
            self.random.choice(queue.unfinished).stop()
        elif self.random.random() < 0.2:
            self.window.runs.report_to(self.folder / "report.html")

    def do_pin(self):
        """Pin or unpin a panel by the button on its head."""
        panels = [one for one in self.window.panels.panels.values() if one.isVisible()]
        if panels:
            pin = getattr(self.random.choice(panels).head, "pin", None)
            if pin is not None and pin.isVisible():
                pin.click()

    def do_move_far(self):
        """Pan and zoom to somewhere else."""
        view = self.window.canvas.view
        view.centerOn(QPointF(self.random.uniform(-2e3, 4e3), self.random.uniform(-2e3, 2e3)))
        if self.random.random() < 0.5:
            self.window.canvas.frame_all()

    # --- choosing -------------------------------------------------------------------------------

    def select_some(self, most=5):
        """Select some of the nodes shown."""
        names = list(self.window.level.network.nodes)
        self.random.shuffle(names)
        self.window.level.select(names[: self.random.randint(1, most)])

    def select_macro(self):
        """Select a macro that is shown; its name, or None."""
        level = self.window.level
        macros = [name for name in level.network.nodes if level.is_macro(name)]
        if not macros:
            return None
        name = self.random.choice(macros)
        level.select([name])
        return name


def type_text(widget, text):
    """As `QTest.keyClicks`, which ends the program at letters beyond Latin-1."""
    for letter in text:
        for kind in (QEvent.Type.KeyPress, QEvent.Type.KeyRelease):
            event = QKeyEvent(kind, 0, Qt.KeyboardModifier.NoModifier, letter)
            QApplication.sendEvent(widget, event)
