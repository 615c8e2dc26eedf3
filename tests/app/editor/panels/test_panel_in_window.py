"""The control panel at 1366×768 by real mouse: parameters in sight, and nothing jumps."""

import pytest

from virtual_screen import managed_screen, seen_by


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    with managed_screen(1366, 768) as environment:
        return seen_by("panel_window.py", tmp_path_factory.mktemp("panel"), environment)


def test_the_control_panel_in_a_small_window(seen):
    # Four parameters are in sight on a small screen.
    assert len(seen["visible"]) >= 4
    assert seen["visible"][0] == "integration_time_s"
    assert seen["illustration"] <= 0.36 * seen["panel"]
    # Dragging a slider moves no field.
    for what in ("exposure", "jitter"):
        before, *during = seen[what]["heights"]
        assert before
        assert all(places == before for places in during)
    # A line that comes while a slider is dragged has its place.
    assert seen["jitter"]["badges"][0] == ""
    assert "no effect" in seen["jitter"]["badges"][-1]
    # An illustration is folded by a click and stays so.
    shown, many = seen["before"]
    assert shown
    assert seen["after"][0] is False
    assert seen["after"][1] > many
    assert seen["other kind"]
    # The next start remembers what is folded.
    assert seen["next start"] == {
        "focal_plane": False,
        "init": True,
        "jitter": True,
        "optics": False,  # as at first: its curve stands among the curves
    }
