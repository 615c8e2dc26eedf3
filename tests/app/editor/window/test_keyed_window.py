"""Real keys on a real window: an open menu has them all, and the focus is always in sight."""

from pathlib import Path

import pytest

from virtual_screen import managed_screen, seen_by


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    with managed_screen(1600, 900) as environment:
        return seen_by("keyed_window.py", tmp_path_factory.mktemp("keyed"), environment)


def test_letters_of_an_open_menu_do_nothing_on_the_canvas(seen):
    assert (seen["menu b"], seen["menu r"]) == (1, 1)
    assert not seen["changed by menus"]


def test_f6_visits_every_part_in_sight_and_rings_it(seen):
    names, in_sight, ringed = zip(*seen["parts"], strict=True)
    assert all(in_sight)
    assert all(ringed)
    assert {"canvas", "library", "panels"} < set(names)
    assert len(set(names)) == 5
    assert names[0] == names[5]


def test_tab_raises_what_lies_behind_another_tab(seen):
    assert seen["hidden"] == []


def test_esc_in_a_drag_puts_the_value_back_until_the_button_is_up(seen):
    for before, dragged, *after in seen["drags"]:
        assert dragged != before
        assert after == [before] * 3
    assert not seen["changed by drags"]


def test_enter_in_the_name_gives_the_keyboard_back_to_the_canvas(seen):
    assert seen["after name"]


def test_a_dialog_lists_files_without_opening_them(seen):
    assert Path("/proc", seen["in /proc"]).exists()


def test_no_bar_of_a_single_tab_is_left_in_the_window(seen):
    assert seen["tabs"]["found"]
    assert seen["tabs"]["seen"] == []
