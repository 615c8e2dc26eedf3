"""When a pass gives way, and what share of the time goes to what is no picture.

The clock is set by hand: what is tested is the share, not the machine.
"""

from types import SimpleNamespace

import pytest

from app.editor.evaluation import runner as pace_module
from app.editor.evaluation.runner import Pace

SLOW, FAST = 0.4, 0.05


@pytest.fixture
def clock(monkeypatch):
    made = SimpleNamespace(now=100.0)
    made.perf_counter = lambda: made.now
    monkeypatch.setattr(pace_module, "time", made)
    return made


def test_who_gives_way_to_an_edit():
    for elapsed, expected, has_preview, new_gesture, gives_way in (
        (FAST, FAST, True, True, False),  # a fast pass is always finished
        (SLOW, FAST, True, False, True),  # before a preview, whatever the gesture
        (SLOW, SLOW, False, False, False),  # the same drag waits for its picture
        (SLOW, SLOW, False, True, True),
    ):
        how = {"has_preview": has_preview, "new_gesture": new_gesture}
        assert Pace().gives_way(elapsed, expected, **how) is gives_way


def test_new_gestures_do_not_put_a_picture_off_for_ever():
    """Once more time was wasted than a picture takes, one is finished; then all is as before."""
    pace = Pace()

    def gives_way():
        return pace.gives_way(SLOW, SLOW, has_preview=False, new_gesture=True)

    pace.gave_way(0.3)
    assert gives_way()
    pace.gave_way(0.2)
    assert not gives_way()
    assert pace.gives_way(SLOW, SLOW, has_preview=True, new_gesture=True)
    pace.shown()
    assert gives_way()


@pytest.mark.parametrize(("took", "wait"), [(2.0, 8.0), (0.001, 0.1)])
def test_what_is_no_picture_takes_a_fifth_of_the_time(clock, took, wait):
    """Four times as long a rest as it took, but a tenth of a second at least."""
    pace = Pace()
    assert not pace.rest_may_wait()
    pace.rest_took(took)
    clock.now = 100.0 + 0.999 * wait
    assert pace.rest_may_wait()
    clock.now = 100.0 + 1.001 * wait
    assert not pace.rest_may_wait()
