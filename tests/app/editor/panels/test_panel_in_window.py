"""The control panel at 1366×768 by real mouse: parameters in sight, and nothing jumps."""

import pytest

from virtual_screen import managed_screen, seen_by


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    with managed_screen(1366, 768) as environment:
        return seen_by("panel_window.py", tmp_path_factory.mktemp("panel"), environment)


def test_four_parameters_are_in_sight_on_a_small_screen(seen):
    assert len(seen["visible"]) >= 4
    assert seen["visible"][0] == "integration_time_s"
    assert seen["illustration"] <= 0.36 * seen["panel"]


@pytest.mark.parametrize("what", ["exposure", "jitter"])
def test_dragging_a_slider_moves_no_field(seen, what):
    before, *during = seen[what]["heights"]
    assert before
    assert all(places == before for places in during)


def test_a_line_that_comes_while_a_slider_is_dragged_has_its_place(seen):
    assert seen["jitter"]["badges"][0] == ""
    assert "changes nothing" in seen["jitter"]["badges"][-1]


def test_an_illustration_is_folded_by_a_click_and_stays_so(seen):
    shown, many = seen["before"]
    assert shown
    assert seen["after"][0] is False
    assert seen["after"][1] > many
    assert seen["other kind"]


def test_the_next_start_remembers_what_is_folded(seen):
    assert seen["next start"] == {
        "focal_plane": False,
        "init": True,
        "jitter": True,
        "optics": False,  # as at first: its curve stands among the curves
    }


def test_curves_follow_the_selection_and_stand_in_one_place(seen):
    assert seen["curves of optics"] == {"thick": ["optics"], "on the panel": False}
    assert seen["curves of back"].startswith("back has no curves")
    assert seen["curves of budget"] == "budget.noise"
