"""Expressions against fractions and mpmath, which share no code with them."""

import contextlib
import math
import re
from fractions import Fraction

import mpmath
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from core.errors import check_id
from core.modules.declaration import declaration
from core.network.expressions import (
    LONGEST,
    ExpressionError,
    fitting,
    kind_of,
    parse_expression,
    quoted,
    rewritten,
    symbols,
    value_of,
)
from nodes.library import standard_library


def value(text, unit="", **values):
    return value_of(
        parse_expression(text), unit=unit, lookup=lambda one: values[f"{one.node}_{one.parameter}"]
    )


def refusal(text, unit="", **values):
    with pytest.raises(ExpressionError) as caught:
        value(text, unit, **values)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "unit", "expected"),
    [
        ("2*0.3", "mrad", 0.6),
        ("3*0.1", "", 0.3),
        ("0.1*30", "", 3),
        ("-2^2", "", -4),
        ("2^-1", "", 0.5),
        ("2**3**2", "", 512),
        ("1 - 2 - 3", "", -4),
        ("12 / 2 / 3", "", 2),
        ("2 × 3 ÷ 4 − 1", "", 0.5),
        ("--3", "", 3),
        ("600 urad", "mrad", 0.6),
        ("0.3 mrad", "µrad", 300),
        ("3 um", "µm", 3),
        ("3 µm", "mm", 0.003),
        ("3 \N{GREEK SMALL LETTER MU}m", "µm", 3),
        ("2 m", "mm", 2000),
        ("1/60", "deg", 1 / 60),
        ("(1/60) deg", "mrad", math.pi / 180 / 60 * 1000),
        ("1e3 Hz", "Hz", 1000),
        ("1 kHz", "Hz", 1000),
        ("36 km/h", "m/s", 10),
        ("0.2 1/km", "1/km", 0.2),
        ("50 %", "", 0.5),
        ("min(1, 2 mm, 3)", "m", 0.002),
        ("3 um / 2 mm", "", 0.0015),
        ("round(2.6)", "", 3),
        ("floor(0.3*10)", "", 3),
        ("sin(30 deg)", "mm", 0.5),
        ("a.x * 3", "", 0.3),
        ("a.x mm + 1 m", "mm", 1000.1),
    ],
)
def test_what_it_comes_to(text, unit, expected):
    if text == "3 um / 2 mm":
        unit = "mm"  # where lengths are allowed at all
    assert value(text, unit, a_x=0.1) == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "unit", "part"),
    [
        ("", "", "the expression is empty"),
        ("1 +", "", "not complete; expected: a number"),
        ("(1", "", "not complete; expected: ')'"),
        ("1 2", "", "2 at character 3"),
        ("0,3*2", "", "the decimal point is '.'"),
        ("1 / 0", "", "1 / 0 divides by zero"),
        ("9^9^9^9", "", "too large"),
        ("exp(1000)", "", "exp(1000) is too large"),
        ("1e308*10", "", "too large"),
        ("sqrt(-1)", "", "is not a real number"),
        ("(-8)^(1/3)", "", "is not a real number"),
        ("0^-1", "", "is not a real number"),
        ("sqr(2)", "", "did you mean sqrt?"),
        ("sqrt()", "", "sqrt() has no arguments"),
        ("max(0.5)", "", "max takes two or more numbers, not 1"),
        ("sqrt(1, 2)", "", "sqrt takes one number, not 2"),
        ("sqrt", "", "sqrt is a function"),
        ("__import__('os')", "", "there is no function"),
        ("f_number", "", "write NODE.PARAMETER"),
        ("3 K", "mm", "K is a unit of temperature, but this value is in mm: write m, nm"),
        ("3 K", "", "but this value has no unit"),
        ("3 hz", "Hz", "did you mean Hz?"),
        ("3 um * 2 um", "mm", "two numbers with units"),
        ("1/60 deg", "mrad", "write (1/60) deg"),
        ("2 um ^ 2", "mm", "^ needs pure numbers"),
        ("log(2 mm)", "mm", "log needs pure numbers"),
        ("(2 mm) mm", "mm", "two units"),
        ("1e999", "", "too large"),
        ("(" * 100_000 + "1", "", f"at most {LONGEST}"),
        ("(" * 900 + "1" + ")" * 90, "", "nested more than"),
        ("2^" * 400 + "1", "", "nested more than"),
        ("sqrt(" * 190 + "1", "", "nested more than"),
    ],
)
def test_what_is_refused(text, unit, part):
    assert part in refusal(text, unit)


def test_long_chains_of_signs_and_sums_need_no_stack():
    assert value("-" * 998 + "1") == 1
    assert value("+".join("1" * 500)) == 500


NUMBERS = st.decimals(-1000, 1000, places=3).map(lambda number: f"{number:f}")
REFERENCES = st.sampled_from(["a.x", "a.y", "'no word (at) all'.z"])
VALUES = {"a.x": Fraction(3, 2), "a.y": Fraction(-1, 4), "'no word (at) all'.z": Fraction(7)}


def _grown(children):
    pairs = st.tuples(children, st.sampled_from("+-*/"), children)
    return st.one_of(
        pairs.map(lambda parts: (f"({parts[0][0]} {parts[1]} {parts[2][0]})", parts)),
        children.map(lambda part: (f"-{part[0]}", ("-", part))),
    )


LEAVES = st.one_of(NUMBERS, REFERENCES).map(lambda text: (f"({text})", text))
TREES = st.recursive(LEAVES, _grown, max_leaves=12)


def _by_fractions(tree):
    """The value of what a text was made of: from the tree, not from the text."""
    _, made = tree
    if isinstance(made, str):
        return VALUES.get(made) if made in VALUES else Fraction(made)
    if len(made) == 2:
        return -_by_fractions(made[1])
    left, sign, right = _by_fractions(made[0]), made[1], _by_fractions(made[2])
    if sign == "/":
        assume(right != 0)
        return left / right
    return {"+": left + right, "-": left - right, "*": left * right}[sign]


@given(TREES)
def test_sums_and_products_are_rounded_once(tree):
    expected = _by_fractions(tree)
    found = value_of(parse_expression(tree[0]), unit="", lookup=lambda one: float(VALUES[one.text]))
    assert float(found) == float(expected)


@given(
    st.sampled_from(["sqrt", "exp", "log", "log10", "sin", "cos", "tan", "atan"]),
    st.integers(1, 500),
)
def test_functions_are_those_of_mathematics(name, number):
    with mpmath.workdps(40):
        expected = getattr(mpmath, name)(mpmath.mpf(number) / 8)
        found = mpmath.mpf(float(value(f"{name}({number}/8)")))
        assert abs(found - expected) <= abs(expected) * mpmath.mpf(2) ** -51


@given(st.integers(1, 50), st.integers(-40, 40))
def test_powers(base, exponent):
    with mpmath.workdps(40):
        expected = mpmath.mpf(base) ** exponent
        found = mpmath.mpf(float(value(f"{base}^{exponent}")))
        assert abs(found - expected) <= expected * mpmath.mpf(2) ** -51


@given(st.text(max_size=60))
def test_any_text_is_read_or_refused(text):
    with contextlib.suppress(ExpressionError, KeyError):  # KeyError: it names a parameter
        value(text, "mm")


def _allowed(name):
    try:
        check_id(name)
    except Exception:
        return False
    return True


NODES = st.text(min_size=1, max_size=12).filter(_allowed)


@given(NODES, NODES, NODES)
def test_any_name_that_a_node_may_have_can_be_written(old, other, new):
    assume(len({old, other, new}) == 3)
    text = f"2 * {quoted(old)}.p + {quoted(other)}.q / {quoted(old)}.p"
    named = [(one.node, one.parameter) for one in parse_expression(text).references]
    assert named == [(old, "p"), (other, "q"), (old, "p")]

    def moved(names):
        return lambda node, parameter: (names.get(node, node), parameter)

    renamed = parse_expression(rewritten(text, moved({old: new})))
    assert [one.node for one in renamed.references] == [new, other, new]
    # Two that change places.
    swapped = parse_expression(rewritten(text, moved({old: other, other: old})))
    assert [one.node for one in swapped.references] == [other, old, other]
    # Only one parameter of a node.
    one = parse_expression(rewritten(text, lambda *end: (new, "r") if end[1] == "q" else end))
    assert [(each.node, each.parameter) for each in one.references] == [
        (old, "p"),
        (new, "r"),
        (old, "p"),
    ]


def test_what_cannot_be_read_stays_when_a_node_is_renamed():
    assert rewritten("old.p +", lambda *_: ("new", "p")) == "old.p +"


def test_every_unit_of_the_library_is_known():
    """Else a number typed with the unit that stands beside its field would be refused."""
    units = {
        parameter.param.unit
        for module in standard_library().values()
        for parameter in declaration(module).parameters
        if parameter.kind in ("number", "integer") and parameter.param.unit
    }
    assert {unit for unit in units if not kind_of(unit)} == set()
    for unit in units:
        assert value(f"3 {unit}", unit) == 3


def test_units_measure_one_thing_each():
    for symbol in symbols():
        assert symbol in fitting(symbol)
        assert value(f"1 {symbol}", symbol) == 1


PREFIXES = {"": 1, "n": 1e-9, "µ": 1e-6, "u": 1e-6, "p": 1e-12, "m": 1e-3, "c": 1e-2, "k": 1e3,
            "M": 1e6, "G": 1e9}  # fmt: skip
SIZES = {"deg": math.pi / 180, "°": math.pi / 180, "arcmin": math.pi / 10800,
         "arcsec": math.pi / 648000, "h": 3600, "%": 0.01}  # fmt: skip
PREFIXED = re.compile("([nµupmckMG]?)(m|s|Hz|rad|K|W|A|e-|lx)(?:\\^?([²2]))?")


def size_of(symbol):
    """A unit in the SI's own, by its prefixes; of counts and of units without any, 1."""
    size = 1.0
    for number, part in enumerate(symbol.split("/")):
        match = PREFIXED.fullmatch(part)
        one = SIZES.get(part, 1.0)
        if match and part not in SIZES:
            one = PREFIXES[match[1]] ** (2 if match[3] else 1)
        size = size / one if number else size * one
    return size


@pytest.mark.parametrize("symbol", sorted(symbols()))
def test_every_unit_is_converted_by_its_prefixes(symbol):
    for other in fitting(symbol):
        expected = 3 * size_of(symbol) / size_of(other)
        assert value(f"3 {symbol}", other) == pytest.approx(expected, rel=1e-14)
    if kind_of(symbol) == kind_of("%"):
        assert value(f"3 {symbol}") == pytest.approx(3 * size_of(symbol))
