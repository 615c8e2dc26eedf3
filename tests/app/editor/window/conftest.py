"""The window with an empty network, and with one of the thesis' sensors."""

import pytest
from PySide6.QtCore import QObject, QUrl, Slot
from PySide6.QtGui import QDesktopServices

from canvas_networks import chain_and_free_blur
from core.editing.document import Document
from snapshot_hands import PORT, Person
from window_hands import WindowHands, show_small


@pytest.fixture
def hand(window):
    """Hands on a window with an empty network."""
    made = WindowHands(window)
    made.begin()
    return made


@pytest.fixture
def chain(window, hand, library):
    """A short chain and a free blur, laid out, in a document that counts as saved."""
    window.session.open(Document(chain_and_free_blur(), library=library))
    window.canvas.frame_all()
    hand.focus()
    return window.session


@pytest.fixture
def kodak(window, idle):
    """The window with the Kodak KIR-310, its canvas with the focus."""
    show_small(window, "kodak_kir310")
    idle(window)
    window.activateWindow()
    window.canvas.setFocus()
    return window


@pytest.fixture
def person(window, idle):
    """A person who keeps snapshots of the first network."""
    window.files.open_now("first_steps")
    idle(window)
    window.activateWindow()
    made = Person(window, idle)
    assert made.viewer.choices.port == PORT
    return made


class Browser(QObject):
    """What is opened outside of the window."""

    def __init__(self):
        super().__init__()
        self.opened = []

    @Slot(QUrl)
    def open(self, url):
        self.opened.append(url.toLocalFile())


@pytest.fixture
def browser(qtbot):
    made = Browser()
    QDesktopServices.setUrlHandler("file", made, "open")
    yield made
    QDesktopServices.unsetUrlHandler("file")
