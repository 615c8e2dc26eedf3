"""Records behave as Python's frozen dataclasses."""

import dataclasses
import pickle
from functools import cached_property
from typing import Any

import pytest

from core import records


def family(dataclass: Any) -> tuple[type, ...]:
    @dataclass(frozen=True)
    class Base:
        """Told."""

        first: int
        second: list[int] = dataclasses.field(default_factory=list, compare=False)

        @cached_property
        def double(self):
            return 2 * self.first

    @dataclass(frozen=True)
    class Child(Base):
        third: float = 0.5
        fourth: str = dataclasses.field(default="x", repr=False)

        def __post_init__(self):
            if self.third < 0:
                raise ValueError("negative")

        def __hash__(self):
            return 7

    @dataclass(frozen=True, eq=False, kw_only=True)
    class Named:
        length: float
        width: float = 1.0

    @dataclass(frozen=True)
    class Single:
        value: Any

    @dataclass(frozen=True)
    class Empty:
        pass

    class Plain(Base):
        def __init__(self, first):
            super().__init__(first)
            self.more = 3

    return Base, Child, Named, Single, Empty, Plain


CALLS = [
    (0, (1,), {}), (0, (1, [2]), {}), (0, (), {"first": 1}), (0, (), {}), (0, (1, 2, 3), {}),
    (1, (1, [2], -1.0), {}), (1, (1,), {"third": 2.0, "fourth": "y"}),
    (2, (), {"length": 2}), (2, (2,), {}), (3, (5,), {}), (3, (float("nan"),), {}), (4, (), {}),
    (4, (1,), {}), (5, (4,), {}),
]  # fmt: skip


def seen(classes, number, words, names):
    """What can be observed of one made so, beside another made so."""
    try:
        one, other = (classes[number](*words, **names) for _ in range(2))
    except (TypeError, ValueError) as error:
        return str(error)
    refused = []
    for change in (
        lambda: setattr(one, "first", 2),
        lambda: setattr(one, "unknown", 2),
        lambda: delattr(one, "first"),
    ):
        try:
            change()
            refused.append(None)
        except (dataclasses.FrozenInstanceError, AttributeError) as error:
            refused.append(str(error))
    same_hash = type(one).__hash__ is not None and hash(one) == hash(other)
    changed = repr(dataclasses.replace(one)) if number != 5 else ""
    about = [(f.name, f.kw_only, f.compare) for f in dataclasses.fields(one)]
    own = hash(one) == hash(
        tuple(getattr(one, f.name) for f in dataclasses.fields(one) if f.compare)
    )
    return repr(one), changed, one == other, one == 3, same_hash, own, about, refused, vars(one)


@pytest.mark.parametrize(("number", "words", "names"), CALLS)
def test_a_record_is_made_shown_compared_and_refused_as_a_dataclass(number, words, names):
    public = seen(family(dataclasses.dataclass), number, words, names)
    assert seen(family(records.dataclass), number, words, names) == public


@records.dataclass(frozen=True)
class Kept:
    value: tuple[int, ...]
    more: Any = None


def test_records_are_followed_matched_and_pickled():
    @dataclasses.dataclass(frozen=True)
    class Follows(Kept):
        third: int = 3

    assert Follows((1,)) == Follows((1,), None, 3) != Kept((1,))
    assert pickle.loads(pickle.dumps(Kept((1, 2)))) == Kept((1, 2))
    match Kept((4,), 5):
        case Kept(value, more):
            assert (value, more) == ((4,), 5)
    assert Kept((1,)).__class__.__match_args__ == ("value", "more")
    held = Kept((1,), [])
    held.more.append(held)
    assert repr(held) == "Kept(value=(1,), more=[...])"


def test_a_class_that_is_not_frozen_is_pythons_own():
    @records.dataclass
    class Open:
        value: int = 0

    made = Open()
    made.value = 4
    assert made == Open(4)
    assert Open.__hash__ is None
