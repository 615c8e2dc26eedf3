"""Keeps what the window shows up to date: a worker's thread, and the signals of its answers."""

import gc
import itertools
import sys
import threading
import time
import weakref
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from PySide6.QtCore import QObject, Qt, QTimer, Signal
from PySide6.QtGui import QGuiApplication

from app.editor.evaluation import changes, queries, runner
from app.editor.session import Session
from core.chain.engine import Plan
from core.network.network import Network

PATIENCE_S = 0.33
LOOK_MS = 100
SWITCH_S = 0.001
JOIN_S = 1.0
QUIET_S = 1.0
FRAME_MS = 8
"""News are taken at most so often.

A pass delivers its picture, its figures and its end within milliseconds. All were taken and drawn
in one turn of the event loop, up to 49 ms long; with a pause it takes 25, and as many pictures are
shown: of 4, 8, 12 and 16 ms, 8 had the shortest gaps at their full number.
"""


class _Bell(QObject):
    rung = Signal()

    def ring(self) -> None:
        self.rung.emit()


class Evaluator(QObject):
    """Answers the queries of the parts of the window, again after each change of the document.

    Lives in the window's thread; all work is done in another. Of edits that come while a pass
    runs, the next pass takes the newest.
    """

    planned = Signal(object)  # the first `Plan` of an opened document: nothing is computed yet
    answered = Signal(object)  # an `Answer`; what is wanted most urgently comes first
    badges_changed = Signal(object)  # by node; nodes without a `Badge` are left out
    busy_changed = Signal(object)  # a `Busy` while a pass takes long, None when it has ended
    pass_done = Signal(object)  # a `PassDone`
    # Whether something is shown as it was before the last changes, since `cancel`.
    behind_changed = Signal(bool)

    def __init__(self, session: Session, *, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._session = session
        self._inbox = queries.Inbox()
        bell = _Bell()
        bell.rung.connect(self._rung, Qt.ConnectionType.QueuedConnection)
        self._drawing = QTimer(
            self, singleShot=True, interval=FRAME_MS, timerType=Qt.TimerType.PreciseTimer
        )
        self._drawing.timeout.connect(self._rung)
        self._outbox = queries.Outbox(bell.ring)
        self._runner = runner.Runner(session.library, self._inbox, self._outbox)
        self._thread: threading.Thread | None = None
        self._requests: dict[str, tuple[queries.Request, ...]] = {}
        self._least: dict[str, int] = {}  # generation of an answer that is still of use
        self._numbers = itertools.count(1)
        self.generation = self._finished = 0
        self._document = self._edits = self._generates = self._gestures = 0
        self._planned_document = 0
        self._edited_at = time.perf_counter()
        self.plan: Plan | None = None  # of the network as it was planned last
        self.posted: Network | None = None  # as it is computed; `plan` has it once it is planned
        self._badges: Mapping[str, queries.Badge] = {}
        self._shown_badges: dict[str, queries.Badge] = {}
        self._busy: queries.Busy | None = None
        self._behind = False
        self._closed = False
        self._soon = QTimer(self, singleShot=True, interval=0)
        self._soon.timeout.connect(self._post)
        self._collector = Collector(self._is_quiet, self)
        self._look = QTimer(self, interval=LOOK_MS)
        self._look.timeout.connect(self._look_at_worker)
        session.changed.connect(self._follow_change)
        session.opened.connect(self._follow_opening)
        weakref.finalize(self, self._inbox.tell, stopped=True, newest=None)

    @property
    def idle(self) -> bool:
        """Whether all queries have been answered, and all changes been signalled."""
        return self._finished == self.generation and not self._soon.isActive()

    @property
    def badges(self) -> dict[str, queries.Badge]:
        return dict(self._shown_badges)

    def ask(self, owner: str, wanted: Sequence[queries.Query]) -> None:
        """Keep these queries answered from now on, in place of those the owner had before."""
        before = self._requests.get(owner)
        known = {request.query: request for request in before or ()}
        requests = tuple(
            known.get(query) or queries.Request(owner, query, next(self._numbers))
            for query in wanted
        )
        if requests != before:
            self._least.setdefault(owner, self.generation + 1)
            self._requests[owner] = requests
            self._post_soon()

    def forget(self, owner: str) -> None:
        self._requests.pop(owner, None)
        self._least.pop(owner, None)
        self._post_soon()

    def generate(self) -> None:
        """Compute all afresh, also the nodes that are held back."""
        self._generates += 1
        self._edits += 1
        self._post()

    def cancel(self) -> None:
        """Stop computing; what is shown stays until the next edit or `generate`."""
        if not self.idle:
            self._inbox.tell(cancelled=self.generation)

    def close(self) -> None:
        if self._closed:
            return
        self._closed = True
        self._session.changed.disconnect(self._follow_change)
        self._session.opened.disconnect(self._follow_opening)
        self._soon.stop()
        self._drawing.stop()
        self._outbox.closed = True
        self._inbox.tell(stopped=True, newest=None)
        if self._thread is not None:
            self._thread.join(JOIN_S)
            self._collector.stop(resume=not self._thread.is_alive())
            self._thread = None
            sys.setswitchinterval(self._switch_interval)
        self._finished = self.generation
        self._rest()

    def _follow_change(self, before: Any, after: Any) -> None:
        if not changes.computes_alike(before, after):
            now = time.perf_counter()
            self._gestures += now - self._edited_at > runner.PAUSE_S
            self._edits += 1
            self._edited_at = now
            self._post()

    def _follow_opening(self) -> None:
        self._document += 1
        self._edits += 1
        self._post_soon()  # the views post their queries on it first

    def _post_soon(self) -> None:
        if not self._closed:
            self._soon.start()

    def _post(self) -> None:
        if self._closed:
            return
        self._soon.stop()
        self.generation += 1
        if self._thread is None:
            self._start()
        self.posted, planned = self._session.plain, self._is_planned
        requests = tuple(itertools.chain(*self._requests.values())) if planned else ()
        state = (self.generation, self._document, self.posted, self._session.folder, requests)
        counts = (self._edits, self._generates, self._gestures, self._edited_at)
        self._inbox.tell(newest=queries.Snapshot(*state, *counts, only_planned=not planned))
        if not self._look.isActive():
            self._look.start()

    def _start(self) -> None:
        # A thread waits so long for the interpreter while another computes in it: 1.2 ms each
        # time in place of 5.3. While numpy computes it makes no difference.
        self._switch_interval = sys.getswitchinterval()
        sys.setswitchinterval(min(SWITCH_S, self._switch_interval))
        self._collector.start()
        self._thread = threading.Thread(
            target=self._runner.run, name="imagechain evaluation", daemon=True
        )
        self._thread.start()

    @property
    def _is_planned(self) -> bool:
        """Whether the window has had its chance to choose what it shows of the document."""
        return self._planned_document == self._document

    def _is_quiet(self) -> bool:
        return self.idle and time.perf_counter() - self._edited_at > QUIET_S

    def _rung(self) -> None:
        """Take the worker's news no faster than they can be drawn."""
        if self._outbox.full and not self._drawing.isActive():
            self._take_news()
            self._drawing.start()

    def _take_news(self) -> None:
        news = self._outbox.take()
        if self._closed or news.document != self._document:
            return
        if news.plan is not None:
            self.plan = news.plan
        if news.badges is not None:
            self._badges = news.badges
        if news.finished > self._finished:
            self._finished = news.finished
            if news.unanswered != self._behind:
                self._behind = news.unanswered
                self.behind_changed.emit(self._behind)
        if not self._is_planned and (news.plan is not None or news.finished):
            self._planned_document = self._document
            if news.plan is not None:
                self.planned.emit(news.plan)
            self._post()
        for answer in news.answers.values():
            least = self._least.get(answer.owner)
            if least is not None and answer.generation >= least:  # else its owner has a newer one
                self._least[answer.owner] = answer.generation
                self.answered.emit(answer)
        if self.idle:
            self._rest()
        self._emit_badges()
        for done in news.done:
            self.pass_done.emit(done)

    def _look_at_worker(self) -> None:
        position = self._runner.position
        busy = None
        if position is not None and position.seconds > PATIENCE_S:
            node = position.node  # a preview has nodes that the document has not
            node = node if node in self._session.network.nodes else None
            busy = queries.Busy(node, position.seconds, position.done, position.wanted)
        self._set_busy(busy)
        self._emit_badges()

    def _rest(self) -> None:
        self._look.stop()
        self._set_busy(None)

    def _set_busy(self, busy: queries.Busy | None) -> None:
        if busy != self._busy:
            self._busy = busy
            self.busy_changed.emit(busy)

    def _emit_badges(self) -> None:
        shown = dict(self._badges)
        if self._busy is not None and self._busy.node is not None:
            shown[self._busy.node] = queries.Badge("running", "computing")
        shown = queries.with_macros(shown, self._session.network)
        if shown != self._shown_badges:
            self._shown_badges = shown
            self.badges_changed.emit(dict(shown))


# Collecting Python's garbage in the window's thread, and the long way only in quiet moments.
#
# A collection of all objects stops every thread, longer the more there are (14 ms of 42 000), and
# starts when a computation allocates most: the event loop stood still for 105 to 142 ms while a
# scene was drawn, 18 to 53 ms without it. It may also take widgets apart in a worker's thread,
# which Qt does not allow: what is left of a closed window holds widgets, and the process hangs or
# crashes.

COLLECT_MS = 200


class Collector(QObject):
    """Takes the place of Python's own collector; `is_quiet`: a stop of 0.1 s goes unnoticed."""

    def __init__(self, is_quiet: Callable[[], bool], parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._is_quiet = is_quiet
        self._was_on = False
        self._timer = QTimer(self, interval=COLLECT_MS)
        self._timer.timeout.connect(self._look)

    def start(self) -> None:
        self._was_on = gc.isenabled()
        gc.disable()
        self._timer.start()

    def stop(self, *, resume: bool = True) -> None:
        """Collect no more; Python does again, unless a thread goes on computing."""
        self._timer.stop()
        if resume and self._was_on:
            gc.enable()

    def _look(self) -> None:
        """Collect what is due by Python's own thresholds."""
        due = [count > most for count, most in zip(gc.get_count(), gc.get_threshold(), strict=True)]
        resting = QGuiApplication.mouseButtons() == Qt.MouseButton.NoButton
        if due[2] and resting and self._is_quiet():
            gc.collect()
        elif due[1] or due[0]:
            gc.collect(1 if due[1] else 0)


# Whether what a part of the window shows is of the network as it stands.

OLD_AFTER_MS = 250  # an answer sooner than that is no older than the picture


class Freshness(QObject):
    """Follows edits and full passes: a preview of the pictures leaves all else as it was."""

    changed = Signal(bool)

    def __init__(self, session: Session, evaluator: Evaluator, parent: QObject) -> None:
        super().__init__(parent)
        self._evaluator = evaluator
        self._edit = 0
        self.is_old = False
        self._late = QTimer(self, singleShot=True, interval=OLD_AFTER_MS)
        self._late.timeout.connect(lambda: self._set(True))
        session.changed.connect(self._edited)
        session.opened.connect(self._opened)
        evaluator.pass_done.connect(self._pass_done)

    def catch_up(self, generation: int) -> None:
        """What is shown is of that state of the window, by its number."""
        if generation >= self._edit:
            self._late.stop()
            self._set(False)

    def _opened(self) -> None:
        self.catch_up(self._edit)

    def _edited(self, before: Any, after: Any) -> None:
        if changes.computes_alike(before, after):
            return
        self._edit = self._evaluator.generation
        if not self._late.isActive() and not self.is_old:
            self._late.start()

    def _pass_done(self, done: Any) -> None:
        if isinstance(done, queries.PassDone) and done.reduced == 1 and not done.cancelled:
            self.catch_up(done.generation)

    def _set(self, old: bool) -> None:
        if old != self.is_old:
            self.is_old = old
            self.changed.emit(old)
