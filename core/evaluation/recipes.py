"""Recipes, how a value is made without the value, and the store of the values made.

A recipe has a content key. Two recipes with equal keys give the same value to the last bit, so the
value is made once and shared. Nothing is computed until `Work.value` is called. `Work.part` gives a
region of a picture alone; a recipe that is `in_parts` then makes no more than that.
"""

from __future__ import annotations

import hashlib
import threading
from abc import ABC, abstractmethod
from collections import OrderedDict
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from enum import Enum
from functools import cached_property, partial, update_wrapper
from inspect import signature
from numbers import Integral
from pathlib import Path
from typing import Any, TypeVar
from weakref import WeakValueDictionary

import numpy as np

from core.arrays import Array
from core.errors import ParameterError
from core.machine import is_on_disk, store_bytes
from core.records import dataclass, field, fields, is_dataclass


@dataclass(frozen=True)
class Region:
    """Samples from row `top` and column `left` on, counted from 0; at least one."""

    top: int
    left: int
    rows: int
    columns: int

    def __post_init__(self) -> None:
        for name, least in (("top", 0), ("left", 0), ("rows", 1), ("columns", 1)):
            value = getattr(self, name)
            if not isinstance(value, Integral) or value < least:
                raise ParameterError(f"region's {name}", value, f"a whole number, {least} or more")

    def __str__(self) -> str:
        return f"{self.top}:{self.bottom},{self.left}:{self.right}"

    @property
    def bottom(self) -> int:
        return self.top + self.rows

    @property
    def right(self) -> int:
        return self.left + self.columns

    @property
    def shape(self) -> tuple[int, int]:
        return self.rows, self.columns

    @property
    def slices(self) -> tuple[slice, slice]:
        return slice(self.top, self.bottom), slice(self.left, self.right)

    def within(self, shape: tuple[int, int]) -> Region:
        """The region itself if a picture of that shape has all of it."""
        if self.bottom > shape[0] or self.right > shape[1]:
            picture = f"within the picture's {shape[0]} rows and {shape[1]} columns"
            raise ParameterError("region", str(self), picture)
        return self

    def broadcast(self, shape: tuple[int, int]) -> Region:
        """The region of an array broadcast against the picture: an axis of length 1 whole."""
        top, rows = (0, 1) if shape[0] == 1 else (self.top, self.rows)
        left, columns = (0, 1) if shape[1] == 1 else (self.left, self.columns)
        return Region(top, left, rows, columns)

    def cut(self, array: Array) -> Array:
        rows, columns = array.shape
        return array[self.broadcast((rows, columns)).slices].copy()

    def overlap(self, other: Region) -> Region | None:
        top, left = max(self.top, other.top), max(self.left, other.left)
        rows = min(self.bottom, other.bottom) - top
        columns = min(self.right, other.right) - left
        return Region(top, left, rows, columns) if rows > 0 and columns > 0 else None

    def seen_from(self, other: Region) -> tuple[slice, slice]:
        """Index of the samples in the array of a region around this one."""
        top, left = self.top - other.top, self.left - other.left
        return slice(top, top + self.rows), slice(left, left + self.columns)

    def blocks(self, columns: int, size: int) -> list[int]:
        lines = np.arange(self.top, self.bottom) * columns
        first, last = (lines + self.left) // size, (lines + self.right - 1) // size
        bounds = set(zip(first.tolist(), last.tolist(), strict=True))
        return sorted({block for low, high in bounds for block in range(low, high + 1)})


def runs(start: int, stop: int, columns: int) -> Iterator[Region]:
    """Samples start … stop − 1 of a picture, line after line, as rectangles.

    These are the end of a row, whole rows and the beginning of a row, as far as there are any.
    """
    row, column = divmod(start, columns)
    if column:
        width = min(stop - start, columns - column)
        yield Region(row, column, 1, width)
        start += width
    if rows := (stop - start) // columns:
        yield Region(start // columns, 0, rows, columns)
        start += rows * columns
    if start < stop:
        yield Region(start // columns, 0, 1, stop - start)


F = TypeVar("F", bound=Callable[..., Any])
Share = Callable[[Region, tuple[int, int]], float]
Evaluation = Any
"""The `core.evaluation.work.Work` that computes recipes. It imports them; they do not import it."""


class Recipe(ABC):
    """Something that can be computed, identified by its content key."""

    node: str | None

    @property
    def inputs(self) -> tuple[Recipe, ...]:
        return ()

    @property
    def made_of(self) -> Iterable[Recipe]:
        return self.inputs

    @property
    def needs(self) -> tuple[Recipe, ...]:
        """Recipes whose values `compute` may read, as far as that is known before.

        Their values are held until this one is made, whatever their size.
        """
        return self.inputs

    def first(self, work: Evaluation) -> tuple[Recipe, ...]:  # noqa: ARG002  (others look at what is there)
        """Recipes that are certainly read, made one after the other before `compute` is called.

        A chain of any length is then made without one step waiting within the next.
        """
        return self.inputs

    @property
    def lineage(self) -> Any:
        """What becomes of a picture in it; None where nothing behind it can be followed.

        Its vocabulary is that of `core.chain.step_lineage`, and not known here.
        """
        return None

    @cached_property
    def key(self) -> str:
        """Content key; fields declared with ``compare=False`` do not enter it."""
        for recipe in furthest_first(
            [self], lambda one: one.made_of, lambda one: "key" in vars(one)
        ):
            if recipe is not self:
                recipe.key  # noqa: B018  (stored in the recipe: no key is then made within another)
        return content_key(type(self).__qualname__, *self._content())

    @abstractmethod
    def _content(self) -> tuple[object, ...]:
        """What the key is made of."""

    @abstractmethod
    def compute(self, work: Evaluation) -> Any:
        """Make the value; inputs come from `work.value`."""

    @property
    def in_parts(self) -> bool:
        """Whether a region of the picture can be made without the rest."""
        return False

    @property
    def by_rows(self) -> bool:
        """Whether a block of rows takes no more than its share of the whole picture's work."""
        return self.in_parts

    @property
    def in_blocks(self) -> bool:
        """Whether pictures of any size go in and out: it holds blocks of those on disk alone."""
        return self.by_rows

    @property
    def in_words(self) -> str:
        """What it does, for a line that says so; empty where its name does."""
        return ""

    @property
    def held_size(self) -> tuple[int, int] | None:
        """Rows and columns of what it holds of pictures on disk, of whatever size; None: all."""
        return None

    def compute_part(self, work: Evaluation, region: Region) -> Any:
        """Make a region, bit-identical to the whole; by default cut from it."""
        return region.cut(work.value(self))

    def share(self, region: Region, shape: tuple[int, int]) -> float:
        """Share of the whole picture's work that a region takes; by default of its samples."""
        return region.rows * region.columns / (shape[0] * shape[1])


def furthest_first(
    recipes: Iterable[Recipe],
    parts: Callable[[Recipe], Iterable[Recipe]],
    is_known: Callable[[Recipe], bool],
) -> Iterator[Recipe]:
    """Recipes and their parts, each after its own parts; what is known by then is left out."""
    path = [(recipe, iter(parts(recipe))) for recipe in reversed(list(recipes))]
    while path:
        recipe, coming = path[-1]
        fresh = next((one for one in coming if not is_known(one)), None)
        if fresh is not None:
            path.append((fresh, iter(parts(fresh))))
            continue
        path.pop()
        if not is_known(recipe):
            yield recipe


@dataclass(frozen=True, eq=False)
class Step(Recipe):
    """A module-level function, called as ``function(work, *values, **parameters)``.

    `inputs` are the recipes of the values, `parameters` hashable; an error belongs to the `node`.
    """

    function: Callable[..., Any]
    inputs: tuple[Recipe, ...] = ()
    parameters: tuple[tuple[str, Any], ...] = ()
    node: str | None = field(default=None, compare=False)

    @classmethod
    def of(
        cls,
        function: Callable[..., Any],
        *inputs: Recipe,
        node: str | None = None,
        **parameters: Any,
    ) -> Step:
        """Write ``Step.of(f, a, b, sigma=2)`` for f(work, a's value, b's value, sigma=2)."""
        return cls(function, inputs, tuple(sorted(parameters.items())), node)

    @property
    def made_of(self) -> Iterable[Recipe]:
        yield from self.inputs
        for _, value in self.parameters:
            yield from (value,) if isinstance(value, Recipe) else getattr(value, "recipes", ())

    def _content(self) -> tuple[object, ...]:
        return self.function, tuple(recipe.key for recipe in self.inputs), self.parameters

    def compute(self, work: Evaluation) -> Any:
        values = [work.value(recipe) for recipe in self.inputs]
        work.check()
        return self.function(work, *values, **dict(self.parameters))

    @property
    def in_parts(self) -> bool:
        return hasattr(self.function, "part")

    @property
    def in_blocks(self) -> bool:
        able = self._mark("in_blocks")
        return bool(able(**dict(self.parameters))) if able else super().in_blocks

    @property
    def held_size(self) -> tuple[int, int] | None:
        size = self._mark("held_size")
        return size(**dict(self.parameters)) if size else None

    def compute_part(self, work: Evaluation, region: Region) -> Any:
        return self._mark("part")(work, region, *self.inputs, **dict(self.parameters))

    @property
    def lineage(self) -> Any:
        return (self._mark("lineage") or _ended)(self)

    @property
    def reason(self) -> Step | None:
        """Makes the text of why the value is None, if the function is marked with one."""
        why = self._mark("reason")
        return Step(why, self.inputs, self.parameters, self.node) if why else None

    def share(self, region: Region, shape: tuple[int, int]) -> float:
        share: Share = self._mark("share") or super().share
        return share(region, shape)

    def _mark(self, name: str) -> Any:
        return getattr(self.function, name, None)


def marked(**marks: Any) -> Callable[[F], F]:
    """Mark a step's function: what it is asked for later stands in its attributes.

    `held_size` is called with the parameters of a function that cuts a region from pictures and
    makes none: rows and columns of the region. `whole_numbers`: it makes those from 0 to
    2^bits − 1, by its `bits`. `reason` is called as the function itself where its value is None: it
    gives the reason, empty where none is known.
    """

    def mark(function: F) -> F:
        vars(function).update(marks)
        return function

    return mark


def in_parts(part: Callable[..., Any], share: Share | None = None) -> Callable[[F], F]:
    """Mark a step's function with another that makes a region of its result.

    It is called as ``part(work, region, *inputs, **parameters)``, where `inputs` are the recipes,
    and calls `work.part` or `work.parts` for what it needs of them. `share` is called with region
    and shape of the picture: the share of the whole's work that the region takes.
    """
    return marked(part=part, share=share)


Seen = Callable[[Region], Any]
"""What an input has in a region; a value that is no array whole."""


def by_region(
    shape: Callable[..., tuple[int, int]], share: Share | None = None
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """A step of a function that makes a region of its result; the whole is one, too.

    It is called as ``function(work, region, *inputs, **parameters)`` with each input as `Seen`.
    `shape`, called with the whole inputs and the parameters, gives rows and columns of the whole.
    """

    def step(function: Callable[..., Any]) -> Callable[..., Any]:
        def part(work: Evaluation, region: Region, *inputs: Recipe, **parameters: Any) -> Any:
            given = (partial(work.part, one) for one in inputs)
            return function(work, region, *given, **parameters)

        def whole(work: Evaluation, *inputs: Any, **parameters: Any) -> Any:
            region = Region(0, 0, *shape(*inputs, **parameters))
            return function(work, region, *(partial(_seen, one) for one in inputs), **parameters)

        update_wrapper(whole, function)
        work, _, *others = signature(function).parameters.values()
        whole.__signature__ = signature(function).replace(  # type: ignore[attr-defined]
            parameters=[work, *others]
        )
        return in_parts(part, share)(whole)

    return step


def _seen(value: Any, region: Region) -> Any:
    if not isinstance(value, np.ndarray):
        return value
    return value[region.broadcast(value.shape).slices]


def pointwise(function: F) -> F:
    """Mark a step's function that makes each sample of the pictures' samples at its place."""

    def part(work: Evaluation, region: Region, *inputs: Recipe, **parameters: Any) -> Any:
        return function(work, *work.parts(inputs, region), **parameters)

    return in_parts(part)(function)


def in_blocks(able: Callable[..., bool] = lambda **_: True) -> Callable[[F], F]:
    """Mark a step's function that takes and makes pictures that lie on disk, as `Work.empty` does.

    Of those it holds blocks alone: they may be larger than memory. `able` is called with the step's
    parameters: whether it does so with them.
    """
    return marked(in_blocks=able)


def number_bits(recipe: Recipe) -> int | None:
    """Bits of the whole numbers that a recipe makes; None where its function is not marked so."""
    if not isinstance(recipe, Step) or not hasattr(recipe.function, "whole_numbers"):
        return None
    bits: int = dict(recipe.parameters)["bits"]
    return bits


def ends_lineage(function: F) -> F:
    """Mark a step's function that makes a picture, but carries none on.

    It makes a pattern, or a picture of which no transfer function is known; figures and curves need
    no mark. What does carry one on is marked in the words of `core.chain.step_lineage`.
    """
    return marked(lineage=_ended)(function)


def _ended(_: Step) -> None:
    """Nothing behind the step is followed."""


# Content keys: equal keys mean equal values, whatever process made them.


def content_key(*parts: object) -> str:
    """Hash `parts` to 32 hexadecimal digits.

    Understands what recipes are made of: plain values, tuples, mappings, enumerations, module-level
    functions, small arrays, frozen dataclasses (fields with ``compare=False`` do not count) and
    anything that has a `key` of its own.
    """
    # The text of plain values is made in one go: half the time of feeding the hash bit by bit.
    text = repr(_plain(parts)).encode("utf-8", "surrogatepass")
    return hashlib.blake2b(text, digest_size=16).hexdigest()


def _plain(part: Any) -> Any:
    """Nested tuples of plain values, of which no two with different content look the same."""
    kind = type(part)
    if kind in _PLAIN:
        return part
    if kind is tuple or kind is list:
        return tuple([_plain(item) for item in part])
    key = getattr(part, "key", None)
    if isinstance(key, str) and not isinstance(part, type):
        return ("key", key)
    if isinstance(part, np.generic):
        return part.item()
    if isinstance(part, np.ndarray):
        return ("array", part.dtype.str, part.shape, np.ascontiguousarray(part).tobytes())
    return _plain_object(part)


def _plain_object(part: Any) -> tuple[Any, ...]:
    if isinstance(part, Path):
        return ("path", str(part))
    if isinstance(part, tuple | list):
        return tuple([_plain(item) for item in part])
    if isinstance(part, Mapping):
        return ("mapping", _plain(tuple(sorted(part.items()))))
    if isinstance(part, Enum):
        return ("member", type(part).__qualname__, part.name)
    if isinstance(part, partial):
        return ("partial", _plain((part.func, part.args, part.keywords)))
    if is_dataclass(part) and not isinstance(part, type):
        name = f"{type(part).__module__}.{type(part).__qualname__}"
        return (name, *[_plain(getattr(part, f.name)) for f in fields(part) if f.compare])
    if callable(part) and "<" not in getattr(part, "__qualname__", "<"):
        name = f"{part.__module__}.{part.__qualname__}"
        return ("function", name, getattr(part, "version", 1))
    raise TypeError(f"cannot make a content key from {type(part).__name__}")


_PLAIN = frozenset({str, int, float, bool, type(None)})


# The store of computed values: least recently used out first, bounded in bytes.
#
# A pinned value stays, whatever its size, until the last one lets it go.


def _parts(value: object) -> Collection[object]:
    if isinstance(value, tuple | list):
        return value
    return (value if isinstance(value, dict) else getattr(value, "__dict__", {})).values()


def size_in_bytes(value: object) -> int:
    """Bytes of memory a value keeps alive, nearly: arrays count, and containers of arrays."""
    if is_on_disk(value):
        return 64
    if isinstance(value, np.ndarray):
        return int(value.nbytes)
    return 64 + sum(map(size_in_bytes, _parts(value)))


def freeze(value: object) -> None:
    """Make the arrays of a value read-only: what is handed out is shared."""
    if isinstance(value, np.ndarray):
        value.flags.writeable = False
        return
    for part in _parts(value):
        freeze(part)


_ABSENT = object()


class Store:
    """Values by key. One computation per key at a time; safe to share between threads.

    `capacity_bytes` may stay beside what is pinned; by default what the machine's memory allows.
    """

    def __init__(self, capacity_bytes: int | None = None) -> None:
        self.capacity_bytes = store_bytes() if capacity_bytes is None else capacity_bytes
        self._values: OrderedDict[str, tuple[Any, int]] = OrderedDict()
        self._pinned: dict[str, tuple[Any, int]] = {}
        self._pins: dict[str, int] = {}
        self.used_bytes = 0
        self._lock = threading.Lock()
        self._running: WeakValueDictionary[str, Any] = WeakValueDictionary()
        """Locks of the keys that are under computation, as long as a thread holds or awaits one."""

    def __len__(self) -> int:
        return len(self._values) + len(self._pinned)

    @property
    def pinned(self) -> int:
        return len(self._pins)

    def peek(self, key: str, default: Any = None) -> Any:
        """The value of `key` if it is there, else `default`; never computes."""
        with self._lock:
            entry = self._values.get(key)
            if entry is not None:
                self._values.move_to_end(key)
                return entry[0]
            entry = self._pinned.get(key)
            return default if entry is None else entry[0]

    def holds(self, key: str) -> bool:
        return self.peek(key, _ABSENT) is not _ABSENT

    def pin(self, key: str) -> bool:
        """Keep the value of `key`, or what it will be, until unpinned as often; if it is there."""
        with self._lock:
            self._pins[key] = self._pins.get(key, 0) + 1
            entry = self._values.pop(key, None)
            if entry is not None:
                self._pinned[key] = entry
                return True
        return self.holds(key)

    def unpin(self, key: str) -> None:
        """Take back one `pin`; after the last the value stays while there is room."""
        with self._lock:
            left = self._pins[key] - 1
            if left:
                self._pins[key] = left
                return
            del self._pins[key]
            entry = self._pinned.pop(key, None)
            if entry is not None:
                self.used_bytes -= entry[1]
                self._keep(key, *entry)

    def get(self, key: str, compute: Callable[[], Any]) -> Any:
        """The value of `key`, computed if it is not there.

        A second thread that reads a key under computation waits for it. An error is not kept:
        the next read tries again.
        """
        stored = self.peek(key, _ABSENT)
        if stored is not _ABSENT:
            return stored
        with self._lock:
            running = self._running.setdefault(key, threading.RLock())
        with running:
            stored = self.peek(key, _ABSENT)
            if stored is not _ABSENT:
                return stored
            value = compute()
            freeze(value)
            if isinstance(value, np.ndarray):
                value = value.view()  # a view of a read-only array cannot be made writeable
            self._put(key, value)
            return value

    def drop(self, key: str) -> None:
        with self._lock:
            self.used_bytes -= self._values.pop(key, (None, 0))[1]

    def clear(self) -> None:
        with self._lock:
            self._values.clear()
            self._pinned.clear()
            self.used_bytes = 0

    def _put(self, key: str, value: Any) -> None:
        size = size_in_bytes(value)
        with self._lock:
            for entries in (self._values, self._pinned):
                self.used_bytes -= entries.pop(key, (None, 0))[1]
            if key not in self._pins:
                self._keep(key, value, size)
                return
            self._pinned[key] = (value, size)
            self.used_bytes += size
            self._make_room()

    def _keep(self, key: str, value: Any, size: int) -> None:
        """Take in a value that is not pinned; one too large leaves the others alone.

        Nor does one on disk stay: there it would never be too much.
        """
        if size <= self.capacity_bytes and not is_on_disk(value):
            self._values[key] = (value, size)
            self.used_bytes += size
            self._make_room()

    def _make_room(self) -> None:
        while self.used_bytes > self.capacity_bytes and self._values:
            _, (_, dropped) = self._values.popitem(last=False)
            self.used_bytes -= dropped
