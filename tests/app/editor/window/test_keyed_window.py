"""Real keys on a real window: an open menu has them all, and the focus is always in sight."""

import pytest

from virtual_screen import managed_screen, seen_by


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    with managed_screen(1600, 900) as environment:
        return seen_by("keyed_window.py", tmp_path_factory.mktemp("keyed"), environment)


def test_a_window_worked_by_real_keys(seen):
    # Letters of an open menu do nothing on the canvas.
    assert (seen["menu b"], seen["menu r"]) == (1, 1)
    assert not seen["changed by menus"]
    # F6 visits every part in sight and rings it.
    names, in_sight, ringed = zip(*seen["parts"], strict=True)
    assert all(in_sight)
    assert all(ringed)
    assert {"canvas", "library", "panels"} < set(names)
    assert len(set(names)) == 5
    assert names[0] == names[5]
    # Tab raises what lies behind another tab.
    assert seen["hidden"] == []
    # No bar of a single tab is left in the window.
    assert seen["tabs"]["found"]
    assert seen["tabs"]["seen"] == []
    # Save As into /proc, where some files give nothing to a reader for ever, says one line.
    for said, place in zip(seen["proc"], ("", "/mine.json"), strict=True):
        assert said.startswith(f"not saved: cannot write /proc{place}")
        assert "files cannot be created in /proc" in said
