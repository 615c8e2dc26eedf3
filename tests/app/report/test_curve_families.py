"""Curves of a family: colours of their own, and a legend that is read row by row."""

import itertools

from app.report.drawing.picture_drawing import (
    COLOURS,
    family_colours,
)


def test_a_few_are_told_apart_and_many_go_from_dark_to_bright():
    assert family_colours(3) == list(COLOURS[:3])
    assert family_colours(1) == list(COLOURS[:1])
    many = family_colours(24)
    assert len(set(many)) == 24
    light = [0.2126 * red + 0.7152 * green + 0.0722 * blue for red, green, blue, _ in many]
    assert all(one < other for one, other in itertools.pairwise(light))
