"""The window under a window manager (openbox): its place, its picture, and back to its old size."""

import pytest

from virtual_screen import managed_screen, seen_by

SCREENS = [(1366, 768, 1), (3840, 2160, 2)]  # dots, and what a dot of the window is worth
SHARE = 0.4  # of the window, for the picture
pytestmark = pytest.mark.thorough(always=("1366x768 at 1",))


@pytest.fixture(scope="module", params=SCREENS, ids="{0[0]}x{0[1]} at {0[2]}".format)
def measured(request, tmp_path_factory):
    """What a first start and the next one leave."""
    width, height, scale = request.param
    folder = tmp_path_factory.mktemp("managed")
    with managed_screen(width, height) as environment:
        scaled = {**environment, "QT_SCALE_FACTOR": str(scale)}
        return {w: seen_by("managed_window.py", folder, scaled, w) for w in ("first", "again")}


def within(inner, outer):
    (x, y, wide, high), (left, top, width, height) = inner, outer
    return x >= left and y >= top and x + wide <= left + width and y + high <= top + height


def fills(inside, screen):
    """Whether a window without its title has all of a screen but the title's height.

    At twice the scale Qt rounds odd numbers of dots.
    """
    (x, y, wide, high), (left, top, width, height) = inside, screen
    title = y - top
    return near((x, wide, high), (left, width, height - title), 1) and 0 < title < 40


def near(one, other, dots):
    return all(abs(a - b) <= dots for a, b in zip(one, other, strict=True))


def test_the_window_under_a_window_manager(measured):
    first, again = measured["first"], measured["again"]
    # The first window lies within the screen.
    for what in ("welcome", "first"):
        assert within(first[what]["frame"], first["screen"]), what
        assert not first[what]["maximised"]
    # The picture has two fifths of the window.
    shares = {what: first[what]["share"] for what in first if "share" in first[what]}
    shares |= {f"{what} again": again[what]["share"] for what in again if "share" in again[what]}
    del shares["welcome"]
    assert len(shares) == 8
    assert {what: share for what, share in shares.items() if share < SHARE} == {}
    # Maximised it has the screen and then its old size.
    assert first["maximised"]["maximised"]
    assert fills(first["maximised"]["inside"], first["screen"])
    assert not first["again small"]["maximised"]
    assert near(first["again small"]["inside"], first["first"]["inside"], 1)
    assert near(first["again small"]["picture"], first["first"]["picture"], 3)
    # F11 shows the picture over the whole screen and back.
    assert first["page"]["frame"] == first["page"]["whole"]
    whole = first["page"]["whole"][2] * first["page"]["whole"][3]
    wide, high = first["page"]["picture"]
    assert wide * high > 0.75 * whole
    for before, after in (("maximised", "after page"), ("again small", "small after page")):
        assert near(first[before]["inside"], first[after]["inside"], 1), before
        assert near(first[before]["picture"], first[after]["picture"], 3), before
        assert first[before]["maximised"] == first[after]["maximised"]
    # A maximised window comes back maximised and has its old size.
    assert first["left"]["maximised"]
    assert again["begun"]["maximised"]
    assert fills(again["begun"]["inside"], again["screen"])
    assert not again["small"]["maximised"]
    assert near(again["small"]["inside"], first["small after page"]["inside"], 2)
