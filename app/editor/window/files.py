"""New, open, save, close and dropped files: nothing is lost without a question to the person."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from PySide6.QtCore import QEvent, QObject, QPointF, QTimer, Signal
from PySide6.QtGui import QDropEvent
from PySide6.QtWidgets import QWidget

from app.editor import messages, widgets
from app.editor.canvas.canvas import Canvas
from app.editor.evaluation.evaluator import Evaluator
from app.editor.library_view import LibraryView
from app.editor.session import Level, Session
from app.editor.window.recent_files import Settings
from app.run import own_scene, preset_files
from app.run.shipped import every_network, find_network
from core.chain.engine import Engine
from core.editing.document import Document, mark, rebased
from core.editing.operations import Operation, restored, set_parameter, together
from core.editing.wiring import new_node
from core.errors import ParameterError, several
from core.modules.declaration import Library, declaration, where_absent
from core.network.file import parse_network, read_text
from core.network.macro import expanded, unfolded
from core.network.network import Network
from core.network.validation import NetworkProblems, problems
from core.records import replace

NETWORK_SUFFIX = ".json"
_FILTER = f"Networks (*{NETWORK_SUFFIX});;All files (*)"
_DIALOG = "file_dialog"
Next = Callable[[], object]


class Files(QObject):
    """The document's way from and to files.

    Dialogs open without stopping the window; what is to follow a question is a function that is
    called once it is answered. Only questions block the window: Qt keeps a close that its manager
    sends from a window that is blocked.
    """

    opened = Signal()  # another document is in the window
    about_to_save = Signal()  # what has been typed but not yet entered is to be taken now

    def __init__(self, session: Session, settings: Settings, window: QWidget) -> None:
        super().__init__(window)
        self._session = session
        self._settings = settings
        self._window = window
        self._next: Next | None = None
        self._question: messages.Question | None = None

    def new(self, *_: object) -> None:
        empty = Document(Network(), library=self._session.library)
        self.after_asking(lambda: self.show(empty))

    def open_dialog(self) -> None:
        path = self._session.document.path
        folder = str(path.parent if path else Path.cwd())
        dialog = widgets.labelled(
            messages.FileDialog(self._window, "Open a network", folder, _FILTER), _DIALOG
        )
        dialog.setFileMode(messages.FileDialog.FileMode.ExistingFile)
        dialog.fileSelected.connect(self.open)
        messages.show_beside(self._window, dialog)

    def open(self, text: str) -> None:
        self.after_asking(lambda: self.open_now(text))

    def open_now(self, text: str) -> bool:
        """Open a network in place of the present one; whether that worked."""
        with messages.told(self._session.message.emit, "not opened: "):
            self.show(*open_named(text, library=self._session.library))
            return True
        return False

    def show(self, document: Document, remark: str = "") -> None:
        messages.drop_dialogs(
            self._window, _DIALOG
        )  # it names a file for the document that is closed
        if document.path is not None:
            self._settings.add_recent(document.path)
        self._session.open(document)
        self.opened.emit()
        if remark:
            self._session.message.emit("note", remark)

    def save(self, following: Next | None = None) -> None:
        self.about_to_save.emit()
        path = self._session.document.path
        if path is None:
            self.save_as(following)
        else:
            self.save_to(path, following)

    def save_as(self, following: Next | None = None) -> None:
        """Let the person choose a file and save to it; then go on, if it was saved."""
        self.about_to_save.emit()
        path, title = self._session.document.path, "Save the network"
        taken, folder = partial(self.save_to, following=following), path and path.parent
        dialog = messages.SaveDialog(
            self._window, _DIALOG, title, _FILTER, taken, suffix="json", folder=folder
        )
        dialog.selectFile(str(path) if path else f"{self._session.stem}{NETWORK_SUFFIX}")
        messages.show_beside(self._window, dialog)

    def save_to(self, path: Path, following: Next | None = None, *, over: bool = False) -> None:
        """Save, then go on; file names in the network keep pointing at the same files.

        Another program's changes to the document's own file are written over only with `over`;
        else the person is asked first.
        """
        session, document = self._session, self._session.document
        if not over and document.is_own(path) and (done := document.disagreement()):
            self._next = following
            self._ask(changed_file(self._window, path.name, done))
            return
        here, there = document.folder.absolute(), path.absolute().parent
        moved = rebased(document.network, session.library, here, there)
        changes = moved is not document.network
        if changes:
            session.do(restored(moved, "Adjust file names"))
        if not session.save(path, over=over):
            if changes:
                session.undo()
            return
        self._settings.add_recent(path)
        session.message.emit("note", f"saved {path}")
        if following is not None:
            following()

    def has_unsaved_work(self) -> bool:
        self.about_to_save.emit()
        return self._session.document.modified

    def after_asking(self, following: Next) -> None:
        """Go on with `following`; where there is unsaved work, only once that is answered."""
        if self.has_unsaved_work():
            self.ask_to_save(following)
        else:
            following()

    def ask_to_save(self, following: Next) -> None:
        """Ask the person about unsaved work, then go on. Of two calls the later one goes on."""
        self._next = following
        if self._question is None:
            self._ask(save_changes(self._window, self._session.network.name))
        else:
            self._question.raise_()
            self._question.activateWindow()

    def _ask(self, question: messages.Question) -> None:
        self._question = question
        question.finished.connect(self._answered)
        question.open()

    def _answered(self) -> None:
        question, self._question = self._question, None
        following, self._next = self._next, None
        answer = question.answer if question is not None else "cancel"
        path = self._session.document.path
        if answer == "save":
            self.save(following)
        elif answer == "save_as":
            self.save_as(following)
        elif answer == "discard" and following is not None:
            following()
        elif answer == "overwrite" and path is not None:
            self.save_to(path, following, over=True)
        elif answer == "reload" and path is not None:
            self.open_now(str(path))


# The questions before work is lost. Each blocks the window until it is answered.


def save_changes(parent: QWidget, network: str) -> messages.Question:
    text, more = (
        f"Save the changes to {network or 'this network'}?",
        "Unsaved changes will be lost.",
    )
    box = messages.Question(parent, "save_changes", "Save changes?", text, more)
    box.offer("save", "&Save", messages.ROLE.AcceptRole)
    box.offer("discard", "&Discard", messages.ROLE.DestructiveRole)
    box.offer("cancel", "Cancel", messages.ROLE.RejectRole)
    return box


def changed_file(parent: QWidget, file: str, done: str) -> messages.Question:
    text = f"Another program has {done} {file} since you opened or saved it here."
    more = "Overwrite discards the other program's changes; Reload discards yours."
    if done == "removed":
        more = "Overwrite saves the file again."
    box = messages.Question(parent, "changed_file", "Overwrite it?", text, more)
    box.offer("save_as", "Save &As…", messages.ROLE.AcceptRole)
    if done != "removed":
        box.offer("reload", "&Reload", messages.ROLE.DestructiveRole)
    box.offer("overwrite", "&Overwrite", messages.ROLE.DestructiveRole)
    box.offer("cancel", "Cancel", messages.ROLE.RejectRole)
    return box


# Turning a file into a document that can be worked on.


def open_network_file(path: Path, *, library: Library) -> tuple[Document, str]:
    """Read a network to work on; with a remark, where something is to be said of it.

    Unknown modules stay as placeholders and values that are not allowed stay on their nodes, to be
    mended there. Faults of the wiring, which no canvas could show, are refused.
    """
    text = read_text(path)
    network = parse_network(text, library=library, name_of_source=str(path))
    faults = problems(network, library=library, keep_unknown=True, unfinished=True)
    wiring = [problem for problem in faults if not isinstance(problem, ParameterError)]
    if wiring:
        raise NetworkProblems(wiring)
    document = Document(network, library=library, path=path, stored=mark(text.encode()))
    nodes = unfolded(network).nodes.values()
    modules = [node.module for node in nodes if node.macro is None and node.module not in library]
    remarks = []
    unknown = list(dict.fromkeys(modules))
    if unknown:
        names = ", ".join(unknown[:4]) + (" …" if len(unknown) > 4 else "")
        as_found = "it is" if len(unknown) == 1 else "they are"
        remarks.append(f"{several(len(unknown), 'unknown module')} kept as {as_found}: {names}")
        reasons = (where_absent(module, library) for module in unknown[:4])
        remarks += dict.fromkeys(reason for reason in reasons if reason)
    if faults:
        remarks.append(f"{several(len(faults), 'value')} not allowed: see the marked nodes")
    return document, "; ".join(remarks)


def open_named(text: str, *, library: Library) -> tuple[Document, str]:
    """A network by its path, or a copy of a shipped one by its name, which has no path yet."""
    place = find_network(text)
    document, remark = open_network_file(place.path.absolute(), library=library)
    shipped = place.path in every_network().values()
    return shipped_copy(document) if shipped else document, remark


def shipped_copy(document: Document) -> Document:
    """A shipped network as a new document, in which files shipped with it are named in full."""
    network, folder = document.network, document.folder
    for node in document.network.nodes.values():
        module = document.library.get(node.module)
        if module is None or declaration(module).sink:
            continue
        for name in declaration(module).path_names:
            path = node.params.get(name)
            if isinstance(path, str) and (folder / path).is_file():
                full = str((folder / path).absolute())
                network = network.with_parameter(node.id, name, full)
    return Document(network, library=document.library)


READ_IMAGE = "read_image"
_DRAGGING = (QEvent.Type.DragEnter, QEvent.Type.DragMove, QEvent.Type.Drop)
_DOWN = 190.0  # from one file dropped to the next: a node and its picture have room


class Drops(QObject):
    def __init__(self, session: Level, files: Files, canvas: Canvas, window: QWidget) -> None:
        super().__init__(window)
        self._session = session
        self._files = files
        self._canvas = canvas
        window.setAcceptDrops(True)
        window.installEventFilter(self)

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        """Take files dropped on a part of the window that has no use for them itself."""
        if not isinstance(event, QDropEvent) or event.type() not in _DRAGGING:
            return False
        paths = widgets.local_files(event.mimeData())
        if paths:
            widgets.accept_copy(event)
            if event.type() == QEvent.Type.Drop:
                self._add(paths, QPointF(*self._canvas.surface.cursor_point()))
        return bool(paths)

    def files(self, paths: list[str], point: QPointF) -> None:
        """Open a network, or read pictures: each becomes a Read Image at the point."""
        under = self._canvas.node_or_thumbnail_at(point)
        alone = len(paths) == 1 and not paths[0].lower().endswith(NETWORK_SUFFIX)
        if not (alone and under is not None and self._replaced(under, Path(paths[0]))):
            self._add(paths, point)

    def _add(self, paths: list[str], point: QPointF) -> None:
        networks = [path for path in paths if path.lower().endswith(NETWORK_SUFFIX)]
        if networks:
            self._files.open(networks[0])
            return
        steps: list[Operation] = []
        names, network = [], self._session.network
        for number, path in enumerate(paths):
            at = (point.x(), point.y() + number * _DOWN)
            name, adding = new_node(network, self._session.library, READ_IMAGE, at)
            step = together((adding, set_parameter(name, "path", self._stored(Path(path)))))
            network = step.apply(network)
            steps.append(step)
            names.append(name)
        text = Path(paths[0]).name if len(paths) == 1 else f"{len(paths)} files"
        if self._session.do(together(steps, f"Read {text}")):
            self._session.select(names)

    def _replaced(self, name: str, path: Path) -> bool:
        level = self._session
        network, library = level.network, level.library
        if name not in own_scene.scene_nodes(network, library):
            return False
        plan = Engine(library).plan(expanded(network, library), folder=level.folder)
        scene, stored = own_scene.OwnScene(path, hints=False), self._stored(path)
        with messages.told(level.message.emit):
            new = own_scene.with_own_scene(
                network, scene, library=library, plan=plan, node=name, stored=stored
            )
            if level.do(restored(new.network, f"Replace {name} with {path.name}")):
                level.select([name])
                level.message.emit("note", "; ".join(new.lines))
        return True

    def _stored(self, path: Path) -> str:
        folder = self._session.folder.absolute()
        inside = path.is_relative_to(folder)
        return (path.relative_to(folder) if inside else path).as_posix()


# The presets of the library: added as macros, and saved from them.

_REST_MS = 200


class PresetShelf(QObject):
    """Presets of the library; all are read when asked for, or once the window is at rest.

    Reading them takes 0.2 s, for which the first picture does not wait.
    """

    def __init__(
        self,
        level: Level,
        canvas: Canvas,
        library_view: LibraryView,
        folder: Path,
        evaluator: Evaluator,
    ) -> None:
        super().__init__(library_view)
        self._level = level
        self._evaluator = evaluator
        self._canvas = canvas
        self._view = library_view
        self.folder = folder
        self._listed: tuple[preset_files.Preset, ...] | None = None
        self._rest = QTimer(self, interval=_REST_MS)
        self._rest.timeout.connect(self._at_rest)
        self._rest.start()
        library_view.filter.textEdited.connect(lambda _: self.presets)
        canvas.surface.preset_dropped.connect(self._add_at)

    def _at_rest(self) -> None:
        if self._evaluator.idle:
            self.refresh()

    @property
    def presets(self) -> tuple[preset_files.Preset, ...]:
        return self.refresh() if self._listed is None else self._listed

    def refresh(self) -> tuple[preset_files.Preset, ...]:
        library = self._level.library
        self._rest.stop()
        self._listed = (
            *preset_files.shipped_presets(library),
            *preset_files.own_presets(self.folder, library),
        )
        self._view.show_presets(self._listed)
        return self._listed

    def _add_at(self, key: str, point: QPointF) -> None:
        self.add(key, (round(point.x()), round(point.y())))
        self._canvas.view.setFocus()

    def save(self) -> None:
        level = self._level
        for name in level.selection[-1:]:
            with messages.told(level.message.emit, "not saved as a preset: "):
                node = level.network.nodes[name]
                values = {one: level.value(name, one) for one in node.linked}
                alone = Network(nodes={name: replace(node, params={**node.params, **values})})
                path = preset_files.save_preset(alone, name, self.folder, level.library)
                self.refresh()
                level.message.emit("note", f"saved as a preset: {path}")

    def add(self, key: str, at: tuple[float, float]) -> bool:
        """Put a preset at a place; False for the key of a module."""
        level, preset = self._level, preset_files.preset_of(key, self.presets)
        if preset is None:
            return False
        with messages.told(level.message.emit):
            name, operation = preset_files.placed(
                preset, level.network, level.library, at, level.folder
            )
            if level.do(operation):
                level.select([name])
        return True
