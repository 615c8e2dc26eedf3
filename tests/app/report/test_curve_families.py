"""Curves of a family: colours of their own, and a legend that is read row by row."""

import itertools

import pytest

from app.report.drawing.picture_drawing import (
    COLOURS,
    by_rows,
    family_colours,
    figure,
    legend_columns,
    legend_height_in,
)


def test_a_few_are_told_apart_and_many_go_from_dark_to_bright():
    assert family_colours(3) == list(COLOURS[:3])
    assert family_colours(1) == list(COLOURS[:1])
    many = family_colours(24)
    assert len(set(many)) == 24
    light = [0.2126 * red + 0.7152 * green + 0.0722 * blue for red, green, blue, _ in many]
    assert all(one < other for one, other in itertools.pairwise(light))


@pytest.mark.parametrize(
    "names", [list("abc"), [f"{n / 2:g}" for n in range(3, 13)], ["x" * 40] * 3]
)
@pytest.mark.parametrize("width", [4.6, 10.2])
def test_a_legend_lies_within_its_picture_and_is_read_row_by_row(names, width):
    with figure(width, 2.6 + legend_height_in(names, width)) as (drawn, _):
        axis = drawn.subplots()
        lines = [axis.plot([0, 1], [0, place], label=name)[0] for place, name in enumerate(names)]
        columns = legend_columns(names, width)
        legend = drawn.legend(
            handles=by_rows(lines, columns),
            loc="outside lower center",
            ncols=columns,
            title="camera.f_number",
            fontsize=8.5,
        )
        drawn.canvas.draw()
        box = legend.get_window_extent()
        assert box.x0 >= 0
        assert box.x1 <= drawn.bbox.width
        assert axis.get_window_extent().height > 1.2 * drawn.dpi
        places = [(text.get_window_extent(), text.get_text()) for text in legend.get_texts()]
        in_rows = sorted(places, key=lambda one: (-round(one[0].y0), one[0].x0))
        assert [name for _, name in in_rows] == names
