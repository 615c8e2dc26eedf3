"""The viewer of a wire's picture: which one, how it is drawn, and the sample under the cursor."""

from __future__ import annotations

import weakref
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any, Literal

import numpy as np
from PySide6 import QtCore, QtGui, QtWidgets

from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Answer, Query
from app.editor.session import Session
from app.editor.viewers.picture import picture_facts, picture_query, plots_below, region
from app.editor.viewers.picture.picture_bar import BandBar, PictureBar, list_choices
from app.editor.viewers.picture.picture_canvas import PictureCanvas, Sides
from app.editor.viewers.plot.plot_export import png_bytes
from app.editor.viewers.viewer import PICTURE_TYPES, StatusLine, Viewer, ports_by_node
from app.editor.widgets import Menu, centred_hint, filled, labelled
from app.run.saving import metadata_of, save_array
from core.atomic import write_bytes
from core.chain.wires import Image
from core.errors import UsageError
from core.network.network import Network
from core.records import dataclass, replace
from nodes.files.file_format import CSV, dialog_filter, suffixes
from nodes.files.formats import PNG, SAVED, WRITTEN
from nodes.files.table_cells import csv_columns

Way = Literal["flip", "wipe"]
PAUSE_MS = 30
"""While the cursor moves, the spectrum under it is taken at most so often."""
_SPECTRA = 20  # lines of text that picture and spectra need together
KINDS = ";;".join(
    (
        dialog_filter("Pictures", *(one for one in WRITTEN if not one.plain)),
        dialog_filter("Samples", *(one for one in WRITTEN if one.plain), CSV),
    )
)
HINT = "Choose a wire above, or select a node and press this viewer's number"


@dataclass(frozen=True)
class KeptSide:
    """What a viewer's picture, B, is compared with, and how."""

    # the kept picture, A; None where there is none of this wire, `missing` says why
    kept: picture_query.KeptPicture | None
    name: str  # what the kept state is called
    way: Way  # A in the place of B, or A left of the wipe and B right of it
    missing: str = ""  # why there is nothing to compare with, in one line


class ImageViewer(Viewer):
    """Shows one wire, or two compared, or one as it is beside what was kept of it."""

    export_kinds = KINDS

    def __init__(self, session: Session, evaluator: Evaluator, number: int) -> None:
        super().__init__(session, evaluator, f"image_viewer.{number}")
        self.number = number
        self.window_actions: tuple[QtGui.QAction, ...] = ()
        self.by_hand = False
        """Whether a person chose what it shows; else it follows the end of the chain."""
        self.choices = picture_query.PictureQuery(levels=picture_facts.AUTOMATIC_LEVELS)
        self.picture: picture_query.Picture | None = None
        self._lost: picture_query.PictureQuery | None = None
        self.kept_side: KeptSide | None = None
        """What was kept of the wire, as it is compared now; None where it is not."""
        self.linked: weakref.WeakSet[ImageViewer] = weakref.WeakSet()
        self._place: tuple[int, int] | None = None  # row and column of the probe
        self._failed = False
        self._before_drag: picture_facts.Levels | None = None
        self._sample: tuple[int, int] | None = None  # whose spectrum is shown
        self._pause = QtCore.QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._pause.timeout.connect(self.ask)
        self._full: tuple[Any, picture_facts.Facts] | None = None
        self.setAccessibleName(f"Image viewer {number}")
        self._build()
        self._connect()
        self._set_colours("grey")
        self._follow_choices()

    def look_at(self, port: str | None) -> None:
        """Show a port; an empty text is nothing by choice, None is nothing yet."""
        self._lost, self.by_hand = None, port is not None
        self._choose(port=port or "", mapping=self._mapping_of(port))

    def _mapping_of(self, port: str | None) -> picture_facts.Scale:
        """How a wire is drawn at first: a spectrum, which spans decades, by its logarithm."""
        chosen = self.choices.mapping
        was, now = self._is_spectrum(self.choices.port), self._is_spectrum(port)
        if was == now:
            return chosen
        return "log" if now else "linear" if chosen == "log" else chosen

    def _is_spectrum(self, port: str | None) -> bool:
        node, _, name = (port or "").rpartition(".")
        declared = self.session.declared(node)
        output = declared.output(name) if declared is not None else None
        return output is not None and output.types[0] == "magnitude"

    def add_compare_actions(self, actions: Sequence[QtGui.QAction]) -> None:
        """Offer these actions of the window under Compare, and let their keys work here."""
        self.canvas.addActions(actions)
        if not actions:  # a viewer made before the window's actions: no heading over nothing
            return
        self.bar.menus[1].addSection("With a snapshot")
        self.bar.menus[1].addActions(actions)

    def compare_kept(self, side: KeptSide | None) -> None:
        if side == self.kept_side:
            return
        before, self.kept_side = self.kept_side, side
        if self.picture is not None and not self._failed:
            same = before is not None and side is not None and before.kept is side.kept
            other = self.picture.other if same else None
            self._show(replace(self.picture, other=other, refused=""))
        self.ask()

    def link_to(self, other: ImageViewer, on: bool = True) -> None:
        """Show the same parts of both; links are mutual and not passed on."""
        for one, two in ((self, other), (other, self)):
            (one.linked.add if on else one.linked.discard)(two)
        if on:
            self.canvas.set_zoom(other.canvas.zoom)

    def _apply_zoom(self) -> None:
        for other in list(self.linked):
            other.canvas.set_zoom(self.canvas.zoom)

    def fit(self) -> None:
        self.canvas.fit()
        self._apply_zoom()

    def one_to_one(self) -> None:
        self.canvas.one_to_one()
        self._apply_zoom()

    def export(self, path: Path) -> None:
        """Write the picture as it looks (``.png``), or its samples (``.npy .csv .tif .exr``)."""
        if self.picture is None:
            raise UsageError("the viewer shows no picture")
        picture, side = self.picture, self.kept_side
        if not any(file_format.matches(path) for file_format in SAVED):
            raise UsageError(f"{path}: pictures can be saved as {' '.join(suffixes(*SAVED))}")
        if picture.reduced > 1:
            raise UsageError("the picture is still a preview: wait until it is shown at full size")
        if PNG.matches(path):
            write_bytes(path, png_bytes(self.canvas.image()))
        elif side is not None and side.way == "flip" and picture.other is not None:
            save_samples(picture.other, path)
        else:
            save_samples(picture, path)

    def copy(self) -> None:
        if self.picture is not None:
            QtWidgets.QApplication.clipboard().setImage(self.canvas.image())

    def copy_histogram(self) -> None:
        if self.picture is not None:
            spread, name = self.picture.spread, self.picture.facts.unit or "value"
            columns = [(name, spread.centres.tolist()), ("samples", spread.counts.tolist())]
            QtWidgets.QApplication.clipboard().setText(csv_columns(columns))

    def queries(self) -> tuple[Query, ...]:
        query = self._query
        if query is None or not self.canvas.shows(plots_below.Spectra):
            return () if query is None else (query,)
        mean = plots_below.MeanSpectrumQuery(query.port)
        if self._sample is None:
            return query, mean
        return query, mean, plots_below.SampleSpectrumQuery(query.port, *self._sample)

    def accepts(self, query: Query) -> bool:
        """Whether it is what is chosen; while levels or bands are dragged, also with others."""
        chosen = self._query
        if isinstance(query, plots_below.MeanSpectrumQuery | plots_below.SampleSpectrumQuery):
            return query.port == self.choices.port  # also of a sample that the cursor has left
        if chosen is None or not isinstance(query, picture_query.PictureQuery):
            return False
        alike = query.bands.shown == chosen.bands.shown
        return alike and replace(query, levels=chosen.levels, bands=chosen.bands) == chosen

    def take(self, answer: Answer) -> None:
        """Show a picture, or the last one faintly with the reason why there is none."""
        if not isinstance(answer.query, picture_query.PictureQuery):
            spectra = self.canvas.below.get(plots_below.Spectra)
            left = (
                isinstance(answer.query, plots_below.SampleSpectrumQuery) and self._sample is None
            )
            if isinstance(spectra, plots_below.Spectra) and not left:
                spectra.show_answer(answer)
            return
        self._failed = answer.error is not None
        if isinstance(answer.value, picture_query.Picture):
            picture = self._placed(answer.value)
            self._pages.setCurrentWidget(self.canvas)
            self._show(picture)
            self.region.show_picture(picture, self.choices.port)
        else:
            self.canvas.make_faint()
            self._hint.setText(str(answer.error))  # in sight where no picture was shown before
            node = answer.error.node if answer.error is not None else None
            text = f"Not updated: {node} has an error; see its panel" if node else answer.error
            self.status.show_text(str(text), failed=True)

    def follow(self, before: Network, after: Network) -> None:
        """Follow nodes that are renamed; of one that is deleted show the input, till it is back."""
        moved = (self._lost or self.choices).moved(before, after)
        gone = moved.port != "" and moved.port.rpartition(".")[0] not in after.nodes
        now = moved
        if gone:
            shown = self.choices.port if self._lost else moved.port
            there = shown.rpartition(".")[0] in after.nodes
            port = self._upstream(shown, before, after)
            now = (
                self.choices
                if there
                else picture_query.PictureQuery(port, levels=picture_facts.AUTOMATIC_LEVELS)
            )
        self._lost = moved if gone else None
        if now != self.choices:
            self.choices = now
            self._follow_choices()

    def _upstream(self, port: str, before: Network, after: Network) -> str:
        by_node = ports_by_node(after, self.session.library, PICTURE_TYPES[:1])
        pictures = {port for ports in by_node.values() for port in ports}
        wanted = [port.rpartition(".")[0]] if port else []
        for name in wanted:
            sources = [f"{link.source}.{link.output}" for link in before.links_into(name)]
            if found := next((source for source in sources if source in pictures), None):
                return found
            wanted += [n for s in sources if (n := s.rpartition(".")[0]) not in wanted]
        return ""

    def follow_opening(self) -> None:
        self.kept_side = None
        self.look_at(None)

    @property
    def _query(self) -> picture_query.PictureQuery | None:
        """What is chosen, with a kept picture of the wire in the place of another wire."""
        choices, side = self.choices, self.kept_side
        if not choices.port:
            return None
        if side is not None and side.kept is not None and side.kept.port == choices.port:
            # Levels that were set for a difference are not those of the picture.
            alone = choices.with_(mode="alone") if choices.compares else choices
            return replace(alone, kept=side.kept)
        return choices

    def _show(self, picture: picture_query.Picture) -> None:
        before, self.picture, side = self.picture, picture, self.kept_side
        self.canvas.show_sides(*_sides_of(self.choices, side))
        self.canvas.show_picture(picture)
        against = (side.name, side.way) if side is not None else ()
        text = picture.refused or (side.missing if side is not None else "")
        text = text or picture_query.facts_text(picture, self.choices, *against)
        self.status.show_text(text, failed=bool(picture.refused))
        self._show_bands(picture)
        if self._place and before and before.facts.kind == picture.facts.kind:
            row, column = self._place
            place = before.facts.across.at(column), before.facts.along.at(row)
            self._place = picture_query.index_at(picture.facts, *place)
        else:
            self._place = None
        self._show_sample()

    def _build(self) -> None:
        self.bar = PictureBar(self.session, self.owner, self)
        self.band_bar = BandBar(self.owner, self)  # before the canvas in the order of Tab
        self.canvas = labelled(PictureCanvas(self), f"{self.owner}.canvas")
        self.status = StatusLine(self.owner, "What is shown", "Sample under the cursor", self)
        self.region = region.RegionTool(self, self.canvas, self.bar.region)
        self._hint = centred_hint(HINT, self)
        self._pages = QtWidgets.QStackedWidget(self)
        for page in (self._hint, self.canvas):
            self._pages.addWidget(page)
        parts = (self.bar, self.band_bar, (self._pages, 1), self.status)
        filled(QtWidgets.QVBoxLayout(self), *parts, spacing=1)

    def _connect(self) -> None:
        bar, canvas = self.bar, self.canvas
        bar.ports.chosen.connect(self.look_at)
        bar.fit.clicked.connect(self.fit)
        bar.dots.clicked.connect(self.one_to_one)
        bar.menus[1].aboutToShow.connect(self._fill_menus)
        bar.mapping.chosen.connect(lambda name: self._choose(mapping=name))
        bar.levels.chosen.connect(self._choose_levels)
        bar.colours.chosen.connect(self._set_colours)
        bar.histogram.toggled.connect(canvas.levels.setVisible)
        bar.profile.toggled.connect(partial(canvas.show_below, plots_below.ProfileLine))
        bar.means.toggled.connect(partial(canvas.show_below, plots_below.LineMeans))
        bar.spectra.toggled.connect(self._fit_spectra)
        self.band_bar.chosen.connect(self._choose_bands)
        canvas.band_dragged.connect(self.band_bar.take_line)
        canvas.pointed.connect(self._point_at)
        canvas.stepped.connect(self._step)
        canvas.sigDeviceRangeChanged.connect(self._fit_spectra)
        canvas.band_stepped.connect(self.band_bar.step)
        bar.mode.chosen.connect(lambda name: self._choose(mode=name))
        bar.others.triggered.connect(lambda one: self._choose_other(one.data()))
        bar.links.triggered.connect(lambda one: self._choose_link(one.data(), one.isChecked()))
        self.region.picture_wanted.connect(self._show_for_region)
        canvas.menu_wanted.connect(self._open_menu)
        canvas.zoomed.connect(self._apply_zoom)
        canvas.levels.dragged.connect(self._drag_levels)
        canvas.levels.ended.connect(self._end_drag)

    def _choose(self, **changes: Any) -> None:
        before = self.choices
        self.choices = before.with_(**changes)
        if self.choices != before:
            self._follow_choices()

    def _show_for_region(self, port: str) -> None:
        self._lost, self.by_hand = None, True
        self._choose(port=port, mapping="linear", mode="alone")

    def _show_bands(self, picture: picture_query.Picture | None) -> None:
        bands = picture_facts.bands_of(picture.value) if picture is not None else None
        self.band_bar.show_bands(bands, self.choices.bands)
        self.bar.spectra.setEnabled(bands is not None)
        self._fit_spectra()

    def _choose_bands(self, choice: Any) -> None:
        self._choose(bands=choice)
        self._show_bands(self.picture)

    def _choose_levels(self, name: str) -> None:
        manual = self.picture.levels if self.picture is not None else "extremes"
        self._choose(levels=manual if name == "manual" else name)

    def _choose_other(self, port: str) -> None:
        self._choose(other=port, mode="wipe" if self.choices.mode == "alone" else self.choices.mode)

    def _choose_link(self, number: int, on: bool) -> None:
        for viewer in neighbours(self):
            if viewer.number == number:
                self.link_to(viewer, on)

    def _drag_levels(self, low: float, high: float) -> None:
        if high > low:
            self._before_drag = self._before_drag or self.choices.levels
            self._choose(levels=(low, high))

    def _end_drag(self, given_up: bool) -> None:
        before, self._before_drag = self._before_drag, None
        if given_up and before is not None:
            self._choose(levels=before)

    def _set_colours(self, name: str) -> None:
        self.bar.colours.choose(name)
        self.canvas.set_colours(name)

    def _fit_spectra(self, *_: object) -> None:
        """Show spectra of a picture with bands; of little height the picture has all."""
        wanted = self.bar.spectra.isEnabled() and self.bar.spectra.isChecked()
        fits = self.canvas.height() >= _SPECTRA * self.fontMetrics().height()
        if (wanted and fits) != self.canvas.shows(plots_below.Spectra):
            self.canvas.show_below(plots_below.Spectra, wanted and fits)
            self._pause.start()

    def _point_at(self, place: Any) -> None:
        """The cursor is at a place of the axes, or on no picture."""
        self._place = None
        if place is not None and self.picture is not None:
            self._place = picture_query.index_at(self.picture.facts, *place)
        self.canvas.mark(None)
        self._show_sample()

    def _step(self, columns: int, rows: int) -> None:
        """Move the probe by so many samples, from the middle if there is no place yet."""
        if self.picture is None:
            return
        facts = self.picture.facts
        row, column = self._place or (facts.rows // 2, facts.columns // 2)
        row = min(facts.rows - 1, max(0, row + rows))
        column = min(facts.columns - 1, max(0, column + columns))
        self._place = row, column
        self.canvas.mark((facts.across.at(column), facts.along.at(row)))
        self._show_sample()

    def _show_sample(self) -> None:
        picture, kept = self.picture, self.kept_side is not None
        text = picture_query.sample_text(picture, self._place, kept=kept)
        self.status.show_more(text)
        before, self._sample = self._sample, None
        if text and self._place and picture is not None and picture.facts.kind == "picture":
            row, column = self._place  # of a preview; that at full size has the spectrum
            self._sample = (
                round(picture.facts.along.at(row)),
                round(picture.facts.across.at(column)),
            )
        spectra = self.canvas.below.get(plots_below.Spectra)
        if self._sample not in (None, before) and not self._pause.isActive():
            self._pause.start()
        elif self._sample is None and isinstance(spectra, plots_below.Spectra):
            spectra.forget_sample()

    def _follow_choices(self) -> None:
        choices = self.choices
        self.bar.ports.choose(choices.port)
        self.bar.mapping.choose(choices.mapping)
        automatic = choices.levels if isinstance(choices.levels, str) else "manual"
        self.bar.levels.choose(automatic)
        self.bar.mode.choose(choices.mode)
        if not choices.port:
            self.picture = None
            self.canvas.clear_picture()
            self._hint.setText(HINT)
            self._pages.setCurrentWidget(self._hint)
            self.status.show_text("")
            self._show_bands(None)
            self._point_at(None)
            self.region.show_picture(None, None)
        elif choices.mode != "alone" and choices.other is None:
            self.status.show_text("choose the wire to compare with: Compare > With Other Wire")
        self.ask()

    def _placed(self, picture: picture_query.Picture) -> picture_query.Picture:
        """A preview where the picture is at full size, if that has been shown."""
        about = self.choices.port, self.choices.mapping
        if picture.reduced == 1:
            self._full = about, picture.facts
        elif self._full is not None and self._full[0] == about:
            return replace(picture, facts=picture_facts.laid_over(picture.facts, self._full[1]))
        return picture

    def _open_menu(self, point: QtCore.QPoint) -> None:
        self._fill_menus()
        menu = labelled(Menu(self), "picture_menu")
        menu.aboutToHide.connect(menu.deleteLater)
        menu.addAction("&Fit\tF").triggered.connect(self.fit)
        menu.addAction("&One Sample per Screen Pixel\t1").triggered.connect(self.one_to_one)
        menu.addAction("&Copy Picture").triggered.connect(self.copy)
        if self.picture is not None and not self.picture.channels:
            numbers = menu.addAction("Copy Histo&gram as Numbers")
            numbers.setObjectName("copy_histogram")
            numbers.triggered.connect(self.copy_histogram)
        menu.addSeparator()
        for inner in self.bar.menus:
            menu.addMenu(inner)
        menu.addSeparator()
        menu.addActions(self.window_actions)
        menu.popup(point)

    def _fill_menus(self) -> None:
        bar = self.bar
        by_node = ports_by_node(self.session.network, self.session.library, PICTURE_TYPES)
        others = {port: port for ports in by_node.values() for port in ports}
        list_choices(bar.others, others, {self.choices.other})
        names = {f"Viewer {viewer.number}": viewer.number for viewer in neighbours(self)}
        list_choices(bar.links, names, {viewer.number for viewer in self.linked})


def neighbours(viewer: ImageViewer) -> list[ImageViewer]:
    top: QtWidgets.QWidget = viewer
    while (above := top.parentWidget()) is not None:
        top = above
    others = (other for other in top.findChildren(ImageViewer) if other is not viewer)
    return sorted(others, key=lambda other: other.number)


def _sides_of(choices: picture_query.PictureQuery, side: KeptSide | None) -> tuple[Sides, str, str]:
    """Which picture lies where, and the names of the left and the right one."""
    if side is None:
        return "first left", choices.port, choices.other or ""
    if side.way == "flip":
        return "second alone", f"A  {side.name}", ""
    return "second left", f"A  {side.name}", "B  now"


def save_samples(picture: picture_query.Picture, path: Path) -> None:
    """Write the samples, planes in the order of the FFT as the command line writes them."""
    if picture.channels:
        raise UsageError(
            f"{path}: three bands shown as colours can only be saved as .png: choose .png, or show "
            "one band"
        )
    samples: Any = picture.samples
    if picture.facts.kind == "plane":
        samples = np.fft.ifftshift(samples)
    spatial = isinstance(picture.value, Image) and picture.facts.kind == "picture"
    metadata = metadata_of(picture.value, samples.shape) if spatial else {}
    save_array(path, np.asarray(samples), metadata)
