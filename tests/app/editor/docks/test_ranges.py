"""Which values a trade-off begins with, and in which order they are computed."""

import pytest

from app.editor.docks.tradeoff_plots import PART, Span, coarse_first, usual_span
from core.modules.declaration import declaration
from nodes.library import standard_library

LIBRARY = standard_library()
NUMBERS = [
    (key, parameter.name)
    for key, module in LIBRARY.items()
    for parameter in declaration(module).parameters
    if parameter.kind in ("number", "integer")
]


def parameter(key, name):
    return declaration(LIBRARY[key]).parameter(name)


@pytest.mark.parametrize("key", dict(NUMBERS))
def test_every_number_has_a_range_of_allowed_values(key):
    for name in (name for owner, name in NUMBERS if owner == key):
        declared = parameter(key, name)
        usual = 0.5 if declared.param.below and declared.param.high == 1 else 1
        default = declared.default if isinstance(declared.default, int | float) else usual
        for present in (None, default):
            span = usual_span(declared, present)
            assert span.low < span.high, name
            values = span.values()
            assert values[0] < values[-1], name
            for value in (values[0], values[len(values) // 2], values[-1]):
                assert declared.coerce(value) is not None or value is None


def test_ranges_people_would_choose():
    noise = "electronics_noise"
    for key, name, present, span in (
        # declared from 0 to 1, 0 itself not allowed: the slider begins a thousandth above it
        (noise, "optics_transmission", 0.9, Span(0.001, 1.0)),
        # around the present value: 0 is a blur that says something, 5 mrad would hide it
        ("gaussian_mtf", "sigma_x_mrad", 0.1, Span(0.0, 0.2)),
        (noise, "amplifier_snr", 100.0, Span(50.0, 200.0)),  # 0 would mean empty
        (noise, "d_star", 3e13, Span(3e12, 3e14, log=True)),  # decades
        (noise, "post_poles", 20, Span(1, 100, whole=True)),
    ):
        assert usual_span(parameter(key, name), present) == span, name


@pytest.mark.parametrize("count", [2, 5, 6, 201])
def test_every_value_once_the_coarse_ones_first(count):
    values = tuple(range(count))
    parts = coarse_first(values)
    assert sorted(value for part in parts for value in part) == list(values)
    assert parts[0][:2] == ((0, 4) if count > 4 else (0, 1))
    assert all(len(part) <= PART for part in parts)
