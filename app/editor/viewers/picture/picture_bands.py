"""Bands in an image viewer: the row of controls, the plot of spectra, and their queries."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, QTimer, Signal
from PySide6.QtWidgets import QWidget

from app.editor.evaluation.queries import Answer, Passing, Query
from app.editor.viewers.picture.band_bar import BandBar
from app.editor.viewers.picture.spectrum_plot import NO_SAMPLE, SpectrumPlot
from app.editor.viewers.pixels.picture_choices import BandChoice, bands_of
from app.editor.viewers.pixels.picture_query import Picture
from core.chain.band_stack import BandStack
from core.chain.engine import Plan

_LONGEST = 110  # letters of a problem beside the curves
PAUSE_MS = 30
"""While the cursor moves, the spectrum under it is taken at most so often."""


class PictureBands(QObject):
    """What a viewer has for a picture with bands; nothing of it is there for any other.

    `make_plot` makes the plot of the spectra, below the picture, once there are bands.
    """

    wanted = Signal()  # its queries are others

    def __init__(
        self, bar: BandBar, make_plot: Callable[[], SpectrumPlot], parent: QWidget
    ) -> None:
        super().__init__(parent)
        self.bar = bar
        self._make_plot = make_plot
        self._plot: SpectrumPlot | None = None
        self._bands: BandStack | None = None
        self._port = ""
        self._on = True
        self._height = math.inf
        self._place: tuple[int, int] | None = None
        self._pause = QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._pause.timeout.connect(self.wanted)

    @property
    def plot(self) -> SpectrumPlot:
        """The plot, made now if there is none: it takes a tenth of the time of a viewer."""
        if self._plot is None:
            self._plot = self._make_plot()
            self._plot.dragged.connect(self.bar.take_line)
        return self._plot

    @property
    def is_plot_shown(self) -> bool:
        return self._plot is not None and self._plot.is_shown

    @property
    def queries(self) -> tuple[Query, ...]:
        if not self.is_plot_shown:
            return ()
        mean = MeanSpectrumQuery(self._port)
        if self._place is None:
            return (mean,)
        return mean, SampleSpectrumQuery(self._port, *self._place)

    def show_spectra(self, on: bool) -> None:
        if on != self._on:
            self._on = on
            self._put_plot()

    def fit(self, height: float) -> None:
        """Have that height for picture and plot; the picture goes first."""
        self._height = height
        self._put_plot()

    def show_picture(self, picture: Picture | None, port: str | None, choice: BandChoice) -> None:
        bands = bands_of(picture.value) if picture is not None else None
        self.bar.show_bands(bands, choice)
        self._bands, self._port = bands, port or ""
        if bands is not None and picture is not None:
            unit = picture.value.unit
            if bands.density:
                unit = f"{unit}/µm" if unit else "1/µm"
            self.plot.show_bands(bands, unit, choice.places(bands))
        self._put_plot()

    def point_at(self, place: Any) -> None:
        """The probe is at a row and column of the picture, or nowhere."""
        if place == self._place:
            return
        self._place = place
        if self._place is None:
            if self._plot is not None:
                self._plot.show_sample(None, "")
        elif self.is_plot_shown and not self._pause.isActive():
            self._pause.start()

    def accepts(self, query: Query) -> bool:
        """Whether it is of this picture's spectra; also of a sample that the cursor has left."""
        if not isinstance(query, MeanSpectrumQuery | SampleSpectrumQuery):
            return False
        return query.port == self._port

    def take(self, answer: Answer) -> bool:
        query = answer.query
        if isinstance(query, MeanSpectrumQuery):
            self.plot.show_mean(answer.value, _problem(answer))
        elif isinstance(query, SampleSpectrumQuery):
            self._show_sample(answer, query)
        else:
            return False
        return True

    def _show_sample(self, answer: Answer, query: SampleSpectrumQuery) -> None:
        if self._place is None:  # the cursor has left
            return
        name = _problem(answer)
        if not name:
            place = f"row {query.row}  column {query.column}"
            name = NO_SAMPLE if answer.value is None else place
        self.plot.show_sample(answer.value, name)

    def _put_plot(self) -> None:
        before = self.is_plot_shown
        if self._bands is not None:
            self.plot.show(self._on and self.plot.fits(self._height))
        elif self._plot is not None:
            self._plot.show(False)
        if before != self.is_plot_shown or self._bands is not None:
            self._pause.start()


def _problem(answer: Answer) -> str:
    """Why there is no spectrum; of a long line its end, as it begins with the name of a file."""
    text = "" if answer.error is None else " ".join(str(answer.error).split())
    return text if len(text) <= _LONGEST else f"…{text[1 - _LONGEST :]}"


# The queries of a picture's spectra: its mean, and that of one sample.

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class MeanSpectrumQuery(Query):
    """The mean of every band of the picture on a port; None where it has no bands.

    It waits until edits pause: the whole of a file may have to be read for it.
    """

    waits: ClassVar[bool] = True

    port: str

    def key(self, plan: Plan) -> Hashable:
        bands = bands_of(plan.output(self.port))
        return bands and bands.key

    def answer(self, passing: Passing) -> Vector | None:
        bands = bands_of(passing.plan.output(self.port))
        return None if bands is None else np.asarray(passing.work.value(bands.means()))


@dataclass(frozen=True)
class SampleSpectrumQuery(Query):
    """All bands of one sample of the picture on a port.

    None where the picture has no bands or no such sample, or every band would have to be filtered.
    """

    urgency: ClassVar[int] = 1

    port: str
    row: int
    column: int

    def key(self, plan: Plan) -> Hashable:
        bands = bands_of(plan.output(self.port))
        return bands and (bands.key, self.row, self.column)

    def answer(self, passing: Passing) -> Vector | None:
        image: Any = passing.plan.output(self.port)
        bands = bands_of(image)
        if bands is None or not (0 <= self.row < image.rows and 0 <= self.column < image.columns):
            return None
        recipe = bands.spectrum(self.row, self.column)
        return None if recipe is None else np.asarray(passing.work.value(recipe))
