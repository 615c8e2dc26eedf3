"""The library's modules by group, to be searched, dragged to the canvas or chosen."""

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType

from PySide6 import QtGui, QtWidgets
from PySide6.QtCore import QEvent, QMimeData, QModelIndex, QObject, Qt, Signal

from app.editor.declared_text import label_of, shown_value, tip
from app.editor.theme import theme_of
from app.editor.widgets import filled, labelled, search_field
from app.library_index import declarations
from app.run.preset_files import KEY, Difference, Preset, told_apart
from core.modules.declaration import Declaration, Library
from nodes.files.formats import readable_formats

OWN_PRESETS = "Own presets"
MIME_TYPE = "application/x-imagechain-module"
_KEY = Qt.ItemDataRole.UserRole


def module_data(key: str) -> QMimeData:
    data = QMimeData()
    data.setData(MIME_TYPE, key.encode())
    return data


def dragged_module(data: QMimeData) -> str:
    """The key of the module that is dragged; empty if it is something else."""
    if not data.hasFormat(MIME_TYPE):
        return ""
    return bytes(data.data(MIME_TYPE).data()).decode(errors="replace")


class ModuleTree(QtWidgets.QTreeWidget):
    def __init__(self, library: Library, parent: QtWidgets.QWidget) -> None:
        super().__init__(parent, headerHidden=True, uniformRowHeights=True, dragEnabled=True)
        labelled(self, "library.tree", "Modules of the library")
        self.setTextElideMode(Qt.TextElideMode.ElideMiddle)  # names that begin alike end otherwise
        self.setDragDropMode(QtWidgets.QAbstractItemView.DragDropMode.DragOnly)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setIndentation(self.fontMetrics().averageCharWidth() * 2)
        self._library = library
        self._texts: dict[str, tuple[str, str, str]] = {}
        self.modules: dict[str, QtWidgets.QTreeWidgetItem] = {}
        self.groups: dict[str, QtWidgets.QTreeWidgetItem] = {}
        for key, declared in declarations(library).items():
            item = QtWidgets.QTreeWidgetItem(self._group(declared.group), [declared.listed])
            item.setData(0, _KEY, key)
            self._texts[key] = found_by(declared)
            item.setToolTip(0, declared.text)
            item.setFlags(_ENABLED | _SELECTABLE | Qt.ItemFlag.ItemIsDragEnabled)
            self.modules[key] = item
        self.expandAll()

    def show_presets(self, presets: Sequence[Preset]) -> None:
        """List these presets below all modules, in place of those listed before."""
        apart = told_apart(presets, self._library)
        for key in [key for key in self.modules if key.startswith(KEY)]:
            item = self.modules.pop(key)
            self._texts.pop(key)
            item.parent().removeChild(item)
        for preset in presets:
            kind = f"{preset.kind.capitalize()} presets"
            group = self._group(OWN_PRESETS if preset.own else kind)
            item = QtWidgets.QTreeWidgetItem(group, [preset.title])
            item.setData(0, _KEY, preset.key)
            item.setToolTip(0, tip(about_preset(preset, apart.get(preset.key, ()))))
            item.setDisabled(bool(preset.problem))
            if not preset.problem:
                item.setFlags(_ENABLED | _SELECTABLE | Qt.ItemFlag.ItemIsDragEnabled)
            self._texts[preset.key] = (
                f"{preset.title} presets".casefold(),
                preset.text.casefold(),
                " ".join(preset.modules).replace("_", " "),
            )
            self.modules[preset.key] = item
            group.setExpanded(True)

    def mimeTypes(self) -> list[str]:
        return [MIME_TYPE]

    def mimeData(self, items: Iterable[QtWidgets.QTreeWidgetItem]) -> QMimeData:
        keys = [item.data(0, _KEY) for item in items if item.data(0, _KEY)]
        return module_data(keys[0]) if keys else QMimeData()

    def current_key(self) -> str:
        """The key of the marked module; empty on a group."""
        item = self.currentItem()
        return str(item.data(0, _KEY) or "") if item is not None else ""

    def show_matching(self, typed: str) -> None:
        """Show the modules in which every word occurs, and mark the one that fits best."""
        ranks = {key: rank(texts, typed) for key, texts in self._texts.items()}
        for key, item in self.modules.items():
            item.setHidden(ranks[key] is None)
        for group in self.groups.values():
            there = [group.child(row) for row in range(group.childCount())]
            group.setHidden(all(item.isHidden() for item in there))
            if typed.strip():
                group.setExpanded(True)
        matches = {key: place for key, place in ranks.items() if place}
        if matches:
            self.setCurrentItem(self.modules[min(matches, key=lambda key: matches[key])])
        else:
            self.clearSelection()
            self.setCurrentIndex(QModelIndex())

    def _group(self, name: str) -> QtWidgets.QTreeWidgetItem:
        if name not in self.groups:
            item = QtWidgets.QTreeWidgetItem(self, [name])
            item.setFlags(_ENABLED | _SELECTABLE)
            font = self.font()
            font.setBold(True)
            item.setFont(0, font)
            self.groups[name] = item
        return self.groups[name]


def about_preset(preset: Preset, apart: Sequence[Difference]) -> str:
    """What it is, its whole name first, and the values in which it differs from its siblings."""
    told = (
        f"{label_of(one.name)} {shown_value(one, value)} {one.param.unit}".strip()
        for _, one, value in apart
        if value is not None
    )
    values = " · ".join(dict.fromkeys(told))  # two of its modules may have the same
    differs = f"Values that differ from similar presets: {values}" if values else ""
    return "\n\n".join(filter(None, (preset.title, preset.text, differs)))


class LibraryView(QtWidgets.QWidget):
    """The library with a field that filters it."""

    chosen = Signal(str)  # (key): a module or preset was double-clicked, or Enter pressed on it

    def __init__(self, library: Library) -> None:
        super().__init__()
        labelled(self, "library", "Library")
        self.filter = search_field("library.filter", "Filter the modules", "Filter")
        self.tree = ModuleTree(library, self)
        filled(QtWidgets.QVBoxLayout(self), self.filter, self.tree, margins=(4, 4, 4, 4), spacing=4)
        self.setFocusProxy(self.filter)
        self.filter.textChanged.connect(self.tree.show_matching)
        self.filter.returnPressed.connect(self._choose_current)
        self.filter.installEventFilter(self)
        self.tree.itemActivated.connect(self._choose_current)
        self._colour_groups()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "tree"):
            self._colour_groups()

    def _colour_groups(self) -> None:
        theme, side = theme_of(self), self.fontMetrics().height() // 2
        for name, item in self.tree.groups.items():
            mark = QtGui.QPixmap(side, side)
            mark.fill(QtGui.QColor(theme.groups.get(name, theme.line)))
            item.setIcon(0, QtGui.QIcon(mark))

    def show_presets(self, presets: Sequence[Preset]) -> None:
        self.tree.show_presets(presets)
        self.tree.show_matching(self.filter.text())
        self._colour_groups()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """From the field, the arrows lead to the modules."""
        if (
            watched is self.filter
            and isinstance(event, QtGui.QKeyEvent)
            and event.type() == QEvent.Type.KeyPress
            and event.key() in (Qt.Key.Key_Down, Qt.Key.Key_Up)
        ):
            if self.tree.current_key():
                self.tree.event(event)
            self.tree.setFocus(Qt.FocusReason.OtherFocusReason)
            return True
        return bool(super().eventFilter(watched, event))

    def _choose_current(self, *_: object) -> None:
        key = self.tree.current_key()
        if key:
            self.chosen.emit(key)


_ENABLED, _SELECTABLE = Qt.ItemFlag.ItemIsEnabled, Qt.ItemFlag.ItemIsSelectable


# Search of modules by typed words.

# Common names that are not in its title or summary.
_ALSO: Mapping[str, str] = MappingProxyType(
    {
        "test_scene": "target bars edge star chart",
        "read_image": f"load import DIRSIG {readable_formats()}",
        "mtf_file": "measured lens curve CSV Zemax data sheet bring import",
        "psf_file": "point spread function measured lens star Zemax bring import kernel",
        "poisson_noise": "photon shot noise",
        "periodic_noise": "banding striping coherent",
        "line_of_sight": "LOS PSD power spectral density stabilization pointing drift",
        "tdi_mtf": "time delay integration clock smear",
        "focal_plane": "FPA camera electrons QE well ADC NETD NEI PRNU DSNU dark current TDI "
        "EMCCD APD QWIP excess noise responsivity",
        "noise_3d_source": "1/f flicker NVESD",
        "microbolometer": "uncooled LWIR thermal detector VOx",
        "nuc": "FPN shutter flat field calibration gain offset",
        "electronics_noise": "banding striping fixed pattern FPN NUC ADC",
        "mtf_slices": "OTF plot",
        "measured_mtf": "ROI region of interest knife edge ESF LSF SFR ISO 12233",
        "image_quality": "NIIRS RER interpretability",
        "figures_of_merit": "Johnson TTP FLIR92 NVTherm target",
        "noise_budget": "share contribution breakdown",
        "noise_3d": "3D fixed pattern FPN banding striping",
        "compare_images": "difference RMSE PSNR",
        "spatial_blur": "PSF kernel",
        "camera_geometry": "roll pitch yaw panoramic GSD resample",
        "line_by_line": "panoramic mixed",
    }
)


def found_by(declared: Declaration) -> tuple[str, str, str]:
    """Texts in which a typed word is looked for, those that count most first."""
    readouts = " ".join(readout.name.replace("_", " ") for readout in declared.readouts)
    texts = (
        f"{declared.title}\n{declared.key}\n{declared.group}\n{declared.explained}",
        declared.summary,
        f"{_ALSO.get(declared.key, '')} {readouts}",
    )
    names, summary, further = (text.casefold() for text in texts)
    return names, summary, further


def rank(texts: tuple[str, str, str], typed: str) -> int | None:
    """How well typed words fit, 1 the best; 0 where none is typed, None where one does not occur.

    1 where they are the whole title or key, in any order; then in how many texts all are found;
    last a word that is a title or key with letters left out.
    """
    words = typed.casefold().split()
    if not words:
        return 0
    names = (line.replace("_", " ").split() for line in texts[0].splitlines()[:2])
    if any(sorted(words) == sorted(name) for name in names):
        return 1
    for count in range(1, len(texts) + 1):
        known = " ".join(texts[:count])
        if all(word in known for word in words):
            return count + 1
    if len(words) == 1 and any(_abbreviates(words[0], line) for line in texts[0].splitlines()[:2]):
        return len(texts) + 2
    return None


def _abbreviates(word: str, name: str) -> bool:
    """Whether a word of three letters or more is a name with some left out: `gsmtf`."""
    left = iter(name.replace("_", "").replace(" ", ""))
    return len(word) >= 3 and name[:1] == word[0] and all(c in left for c in word)
