"""Rectangles of samples, and evaluating what lies in one alone."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.errors import ParameterError
from core.evaluation.recipes import Region, Step, Store, in_parts, pointwise, runs
from core.evaluation.work import Policy, Work
from engine_bench import CHAIN, CHAIN_LINKS, Bench, network

PICTURE = np.arange(5 * 7, dtype=float).reshape(5, 7)


@st.composite
def regions(draw, rows, columns):
    top, left = draw(st.integers(0, rows - 1)), draw(st.integers(0, columns - 1))
    height, width = draw(st.integers(1, rows - top)), draw(st.integers(1, columns - left))
    return Region(top, left, height, width)


class TestRectangle:
    @pytest.mark.parametrize(
        ("numbers", "told"),
        [
            ((-1, 0, 1, 1), "region's top = -1 is not allowed: must be a whole number, 0 or more"),
            ((0, -3, 1, 1), "region's left = -3"),
            ((0, 0, 0, 1), "region's rows = 0 is not allowed: must be a whole number, 1 or more"),
            ((0, 0, 1, -5), "region's columns = -5"),
            ((0, 0.5, 1, 1), "region's left = 0.5"),
        ],
    )
    def test_no_rectangle(self, numbers, told):
        with pytest.raises(ParameterError) as failed:
            Region(*numbers)
        assert told in str(failed.value)

    def test_within_a_picture(self):
        assert Region(2, 3, 3, 4).within((5, 7)) == Region(2, 3, 3, 4)
        for beyond in (Region(2, 3, 4, 4), Region(2, 3, 3, 5), Region(5, 0, 1, 1)):
            with pytest.raises(ParameterError, match="within the picture's 5 rows and 7 columns"):
                beyond.within((5, 7))

    def test_cuts_a_copy(self):
        cut = Region(1, 2, 3, 4).cut(PICTURE)
        np.testing.assert_array_equal(cut, PICTURE[1:4, 2:6])
        assert not np.shares_memory(cut, PICTURE)
        assert str(Region(1, 2, 3, 4)) == "1:4,2:6"

    @given(one=regions(9, 8), other=regions(9, 8))
    def test_overlap(self, one, other):
        numbers = np.arange(72).reshape(9, 8)
        both = one.overlap(other)
        expected = np.intersect1d(numbers[one.slices], numbers[other.slices])
        if both is None:
            assert expected.size == 0
            return
        np.testing.assert_array_equal(numbers[both.slices].ravel(), expected)
        for around in (one, other):
            inside = numbers[around.slices][both.seen_from(around)]
            np.testing.assert_array_equal(inside, numbers[both.slices])

    @given(columns=st.integers(1, 9), bounds=st.tuples(st.integers(0, 60), st.integers(1, 30)))
    def test_runs_are_the_samples_in_turn(self, columns, bounds):
        start, stop = bounds[0], sum(bounds)
        numbers = np.arange((stop // columns + 1) * columns).reshape(-1, columns)
        found = list(runs(start, stop, columns))
        samples = np.concatenate([numbers[run.slices].ravel() for run in found])
        np.testing.assert_array_equal(samples, np.arange(start, stop))
        assert len(found) <= 3

    @given(region=regions(9, 8), size=st.integers(1, 30))
    def test_blocks(self, region, size):
        numbers = np.arange(72).reshape(9, 8)
        expected = np.unique(numbers[region.slices] // size)
        np.testing.assert_array_equal(region.blocks(8, size), expected)


def numbers(work, *, node_of):
    return PICTURE.copy()


def largest(work, picture):
    return float(picture.max())


@pointwise
def relative(work, picture, scale):
    return picture / scale


@in_parts(lambda work, region, picture: work.part(picture, region) + 1.0)
def increased(work, picture):
    return picture + 1.0


class Recorded(Work):
    """Work that notes what is computed, and in which order."""

    def __init__(self, **how):
        super().__init__(Policy(precision="double", threads=1), Store(**how))
        self.made = []

    def _compute(self, recipe, region=None):
        self.made.append((recipe.function.__name__, None if region is None else str(region)))
        return super()._compute(recipe, region)


SOURCE = Step.of(numbers, node_of="source")
MORE = Step.of(increased, SOURCE)
REGION = Region(1, 2, 3, 4)


class TestParts:
    def test_of_what_knows_how(self):
        work = Recorded()
        np.testing.assert_array_equal(work.part(MORE, REGION), PICTURE[1:4, 2:6] + 1)
        assert work.made == [("increased", "1:4,2:6"), ("numbers", None)]

    def test_are_kept_and_shared_by_region(self):
        work = Recorded()
        first = work.part(MORE, REGION)
        assert work.part(MORE, REGION) is first
        assert not first.flags.writeable
        work.part(MORE, Region(0, 0, 1, 1))
        assert [name for name, _ in work.made] == ["increased", "numbers", "increased"]

    def test_are_cut_from_a_whole_that_is_known(self):
        work = Recorded()
        whole = work.value(MORE)
        made = list(work.made)
        part = work.part(MORE, REGION)
        np.testing.assert_array_equal(part, whole[1:4, 2:6])
        assert work.made == made
        assert not part.flags.writeable
        assert not np.shares_memory(part, whole)

    @pytest.mark.parametrize("capacity_bytes", [1 << 20, 1])
    def test_of_several_that_need_a_whole_one(self, capacity_bytes):
        """The whole is made before parts of it are wanted, so that none is made twice."""
        work = Recorded(capacity_bytes=capacity_bytes)
        part = work.part(Step.of(relative, MORE, Step.of(largest, MORE)), REGION)
        np.testing.assert_array_equal(part, (PICTURE[1:4, 2:6] + 1) / 35.0)
        if capacity_bytes > 1:
            assert sorted(name for name, _ in work.made) == [
                "increased", "largest", "numbers", "relative",
            ]  # fmt: skip
            assert ("increased", None) in work.made


class TestEngine:
    @pytest.mark.parametrize(
        ("port", "region", "told"),
        [
            (
                "back.image",
                Region(0, 0, 5, 1),
                "back: region = '0:5,0:1' is not allowed: must be "
                "within the picture's 4 rows and 6 columns",
            ),
            (
                "blur.magnitude",
                Region(0, 0, 1, 1),
                "blur: region = '0:1,0:1' is not allowed: only an image has regions, "
                "not a magnitude",
            ),
            ("init.context", Region(0, 0, 1, 1), "not a context"),
        ],
    )
    def test_what_has_no_such_region(self, port, region, told):
        bench = Bench()
        plan = bench.engine.plan(network(CHAIN, CHAIN_LINKS))
        with pytest.raises(ParameterError) as failed:
            bench.engine.value(plan, port, bench.work(), region)
        assert told in str(failed.value)
