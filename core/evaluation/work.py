"""Carrying recipes out: the policy, the store, threads, progress and cancelling."""

import os
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from itertools import chain
from typing import Any, Literal

import numpy as np

from core.errors import Cancelled, ImagechainError, ParameterError, watched
from core.evaluation.recipes import Recipe, Region, Store
from core.machine import ScratchDisk, Workers
from core.records import dataclass

# How accurately and with how many threads to compute: one immutable value, passed along.

Precision = Literal["single", "double"]


@dataclass(frozen=True)
class Policy:
    """Numerical policy of one evaluation.

    `precision` is that of pictures and spectra; vectors and sums are always double. `tolerance` is
    the error budget: stages whose effect, as a fraction of the picture's range, stays below it are
    left out. 0 leaves out exact identities only; None is an eighth of the samples' rounding. 0
    `threads` are as many as the process may use; results do not depend on them.
    """

    precision: Precision = "single"
    tolerance: float | None = None
    threads: int = 0

    def __post_init__(self) -> None:
        if self.precision not in ("single", "double"):
            raise ParameterError("precision", self.precision, "single or double")
        if self.tolerance is not None and not 0 <= self.tolerance < 1:
            raise ParameterError("tolerance", self.tolerance, "at least 0 and below 1")
        if not 0 <= self.threads <= 1024:
            raise ParameterError("threads", self.threads, "0 (all) to 1024")

    @property
    def dtype(self) -> np.dtype[np.floating]:
        return np.dtype(np.float32 if self.precision == "single" else np.float64)

    @property
    def budget(self) -> float:
        if self.tolerance is None:
            return float(np.finfo(self.dtype).eps) / 8
        return self.tolerance

    @property
    def workers(self) -> int:
        if self.threads:
            return self.threads
        allowed = getattr(os, "sched_getaffinity", None)  # not on every system
        return len(allowed(0)) if allowed is not None else os.cpu_count() or 1

    @property
    def key(self) -> str:
        """What of the policy a result depends on."""
        return f"{self.precision}/{self.budget!r}"


# What one evaluation requested, and what of it had to be computed.


class EvaluationLog:
    """Notes of one evaluation; nothing that is computed depends on them.

    Each note is one operation on a built-in dict or set, which threads may share.
    """

    def __init__(self) -> None:
        self.requested: dict[str, Recipe] = {}
        """Recipes whose value was requested, by key."""
        self.parts: dict[tuple[str, Region], Recipe] = {}
        """Pictures of which a region was requested."""
        self.computed: set[str | tuple[str, Region]] = set()
        """Those of both whose computation was begun."""
        self.looked_at: set[str] = set()
        """Keys of spectra and transfer functions of which an array was made."""

    def add(self, other: "EvaluationLog") -> None:
        self.requested.update(other.requested)
        self.parts.update(other.parts)
        self.computed |= other.computed
        self.looked_at |= other.looked_at

    def reused(self) -> list[Recipe]:
        """Recipes whose value, or the requested part of it, was there already."""
        whole = [recipe for key, recipe in list(self.requested.items()) if key not in self.computed]
        return whole + [
            recipe
            for (key, region), recipe in list(self.parts.items())
            if key not in self.requested and (key, region) not in self.computed
        ]


Shape = tuple[int, int]
Progress = Callable[[str | None], None]
DEEPEST = 24
"""Parts that are made one within the other; what comes before them is made whole."""


@dataclass(frozen=True)
class BlockRun:
    """A run in blocks: `shapes` has, by key, the pictures among its recipes that lie on disk."""

    disk: ScratchDisk
    shapes: Mapping[str, Shape]

    def slabs_of(self, recipe: Recipe) -> Shape | None:
        """Size of a picture that is made by blocks of rows; None for every other value."""
        return self.shapes.get(recipe.key) if recipe.by_rows else None


class Work:
    """One evaluation: turns recipes into values.

    Store and workers may be shared by several evaluations. `cancel` is set from another thread to
    stop at the next block of work. `progress` is called with a node's id before one of its recipes
    is computed. `blocks` says which pictures lie on disk; without it all of them are in memory.
    """

    def __init__(
        self,
        policy: Policy,
        store: Store,
        cancel: threading.Event | None = None,
        progress: Progress | None = None,
        workers: Workers | None = None,
        blocks: BlockRun | None = None,
    ) -> None:
        self.policy = policy
        self.blocks = blocks
        self._workers = workers if workers is not None else Workers()
        self.store = store
        self.log = EvaluationLog()
        self._cancel = cancel
        self._progress = progress
        self._suffix = f"/{policy.key}"
        self._claims = Claims(store, self._suffix)
        self._nested = threading.local()

    def value(self, recipe: Recipe) -> Any:
        """The value of a recipe, from the store or computed now.

        All that it is made of is made once, whatever the store can hold.
        """
        key = recipe.key
        self.log.requested[key] = recipe
        value = self.store.get(key + self._suffix, lambda: self._made(recipe))
        if key in self._claims.waiting:
            self._claims.settle(recipe)  # another thread has made it
        return value

    @contextmanager
    def hold(self, recipes: Iterable[Recipe]) -> Iterator[Callable[[Iterable[Recipe]], None]]:
        """Hold values that will be read one after the other, and what they are made of.

        Written ``with work.hold(recipes) as release:``. Each is let go of once `release` reports
        that it has been read, the rest when the block ends.
        """
        left: dict[str, list[Recipe]] = {}
        for recipe in recipes:
            left.setdefault(recipe.key, []).append(recipe)
        self._claims.take(one for alike in left.values() for one in alike)
        try:
            yield lambda read: self._claims.give_up([left[one.key].pop() for one in read])
        finally:
            self._claims.give_up(one for alike in left.values() for one in alike)

    def one_by_one(
        self, recipes: Iterable[Recipe], region: Region | None = None, *, forgetting: bool = False
    ) -> Iterator[Any]:
        """The values of recipes in turn; only what the next one shares is held.

        `forgetting` drops what was made for one alone: any number takes the memory of a few.
        """
        held: list[Recipe] = []
        before: Recipe | None = None
        forget = self._forgetting() if forgetting else None
        try:
            for recipe in chain(recipes, [None]):
                if recipe is not None:
                    self._claims.take([recipe])
                    held.append(recipe)
                if before is not None:
                    yield self.value(before) if region is None else self.part(before, region)
                    self._claims.give_up([held.pop(0)])
                    if forget is not None and recipe is not None:
                        forget()
                before = recipe
        finally:
            self._claims.give_up(held)

    def _forgetting(self) -> Callable[[], None]:
        """Drops what has been made since the last call, or the first, and is not held.

        What is made a second time right after it was dropped is shared by all of a row: it stays.
        """
        log = self.log
        computed, looked_at = set(log.computed), set(log.looked_at)
        pictures: tuple[dict[Any, Recipe], ...] = log.requested, log.parts
        known = [(notes, set(notes)) for notes in pictures]
        dropped: set[str | tuple[str, Region]] = set()

        def forget() -> None:
            made = log.computed - computed
            computed.update(made & dropped)
            once = made - dropped
            dropped.clear()
            dropped.update(once)
            for one in once:
                key, region = (one, "") if isinstance(one, str) else (one[0], f"/{one[1]}")
                self.store.drop(f"{key}{self._suffix}{region}")
            log.computed &= computed
            for notes, before in known:
                for one in notes.keys() - before:
                    del notes[one]
            log.looked_at &= looked_at

        return forget

    def forget(self, keys: Iterable[str]) -> None:
        """Drop the values of recipes with these keys, and all parts that this evaluation made."""
        for key in keys:
            self.store.drop(key + self._suffix)
        for key, region in self.log.parts:
            self.store.drop(f"{key}{self._suffix}/{region}")

    def has(self, recipe: Recipe) -> bool:
        return self.store.holds(recipe.key + self._suffix)

    def part(self, recipe: Recipe, region: Region) -> Any:
        """The samples of a picture in a region; a value that is no array comes whole.

        They are cut from the whole where it is known already or has to be made, and the same to
        the bit where they are made alone.
        """
        depth = getattr(self._nested, "parts", 0)
        if recipe.in_parts and depth < DEEPEST and not self.has(recipe):
            self.log.parts[recipe.key, region] = recipe
            with self._part_held(recipe, region, depth) as key:
                return self.store.get(key, lambda: self._compute(recipe, region))
        value = self.value(recipe)
        if not isinstance(value, np.ndarray):
            return value
        self.log.parts[recipe.key, region] = recipe
        cut = region.cut(value)
        cut.flags.writeable = False
        return cut

    def parts(self, recipes: Sequence[Recipe], region: Region) -> list[Any]:
        """The same region of several pictures.

        Those that only come whole are made first: what they are made of is then known, and parts
        of it need not be made once more.
        """
        order = sorted(range(len(recipes)), key=lambda index: recipes[index].in_parts)
        by_index = {index: self.part(recipes[index], region) for index in order}
        return [by_index[index] for index in range(len(recipes))]

    def _disk_for(self, shape: tuple[int, ...], dtype: Any) -> ScratchDisk | None:
        """The disk, where the run is in blocks and memory is not to hold such an array."""
        disk = None if self.blocks is None else self.blocks.disk
        return disk if disk is not None and disk.wants(shape, dtype) else None

    def empty(self, shape: tuple[int, ...], dtype: Any = None) -> Any:
        """An array to be filled in, of the policy's type if none is given; large ones on disk."""
        dtype = self.policy.dtype if dtype is None else dtype
        disk = self._disk_for(shape, dtype)
        return np.empty(shape, dtype) if disk is None else disk.empty(shape, dtype)

    def strips(self, shape: tuple[int, int], dtype: Any = None) -> Any:
        """The same for what is written by rows and read by columns: a `StripArray` on disk."""
        dtype = self.policy.dtype if dtype is None else dtype
        disk = self._disk_for(shape, dtype)
        return np.empty(shape, dtype) if disk is None else disk.strips(shape, dtype)

    def row_slabs(self, picture: Any) -> list[slice]:
        """Blocks of rows to go through a picture: all of it at once where it is in memory."""
        rows, disk = len(picture), self._disk_for(picture.shape, picture.dtype)
        if disk is None:
            return [slice(0, rows)]
        step = disk.slab_rows(picture.shape[1], picture.dtype.itemsize)
        return [slice(top, min(top + step, rows)) for top in range(0, rows, step)]

    def check(self) -> None:
        if self._cancel is not None and self._cancel.is_set():
            raise Cancelled("stopped on request")

    def for_each(self, function: Callable[[Any], None], items: Sequence[Any]) -> None:
        """Call `function` on every item, in threads; items must write to different places."""

        def one(item: Any) -> None:
            self.check()
            with watched(None):  # numpy keeps the state of its errors by thread
                function(item)

        self._workers.for_each(one, items, self.policy.workers)

    def _made(self, recipe: Recipe) -> Any:
        self._claims.begin(recipe)
        try:
            self._make_first(recipe)
            return self._compute(recipe)
        finally:
            self._claims.settle(recipe)

    def _make_first(self, recipe: Recipe) -> None:
        """Make all that the recipe is made of and that is not there, the furthest first."""
        path = [(recipe, iter(self._first(recipe)))]
        try:
            while path:
                current, coming = path[-1]
                fresh = next((one for one in coming if not self.has(one)), None)
                if fresh is not None:
                    self._claims.begin(fresh)
                    path.append((fresh, iter(self._first(fresh))))
                    continue
                if len(path) > 1:
                    self.log.requested[current.key] = current
                    self.store.get(current.key + self._suffix, partial(self._compute, current))
                    self._claims.settle(current)
                path.pop()
        except ImagechainError as error:
            owner = next((current.node for current, _ in reversed(path) if current.node), None)
            if owner is None:
                raise
            raise error.at(owner) from error
        finally:
            for current, _ in path[1:]:
                self._claims.settle(current)

    def _first(self, recipe: Recipe) -> tuple[Recipe, ...]:
        """What has to be there before; of a picture in slabs, what these are not made of by rows.

        The pictures between are then never whole.
        """
        if self.blocks is None or self.blocks.slabs_of(recipe) is None:
            return recipe.first(self)
        needed: dict[str, Recipe] = {}
        waiting, passed = [recipe], {recipe.key}
        while waiting:
            for one in waiting.pop().inputs:
                if one.key in passed:
                    continue
                passed.add(one.key)
                if one.by_rows and not self.has(one):
                    waiting.append(one)
                else:
                    needed[one.key] = one
        return tuple(needed.values())

    def _in_slabs(self, recipe: Recipe, shape: tuple[int, int]) -> Any:
        assert self.blocks is not None
        step = self.blocks.disk.slab_rows(shape[1], 8)
        nested = self._nested
        outside = getattr(nested, "parts", 0), getattr(nested, "pinned", [])
        made: Any = None
        for top in range(0, shape[0], step):
            self.check()
            region = Region(top, 0, min(step, shape[0] - top), shape[1])
            nested.parts, nested.pinned = 1, []
            try:
                slab = recipe.compute_part(self, region)
            finally:
                for key in nested.pinned:  # what the slab is made of goes with it
                    self.store.unpin(key)
                nested.parts, nested.pinned = outside
            if made is None:
                made = self.blocks.disk.empty(shape, slab.dtype)
            made[region.top : region.bottom] = slab
        return made

    @contextmanager
    def _part_held(self, recipe: Recipe, region: Region, depth: int) -> Iterator[str]:
        """Hold a part, and all that the picture is made of, until the outermost part is made."""
        key = f"{recipe.key}{self._suffix}/{region}"
        nested = self._nested
        if depth == 0:
            self._claims.take([recipe])
            nested.pinned = []
        self.store.pin(key)
        nested.pinned.append(key)
        nested.parts = depth + 1
        try:
            yield key
        finally:
            nested.parts = depth
            if depth == 0:
                for pinned in nested.pinned:
                    self.store.unpin(pinned)
                self._claims.give_up([recipe])

    def _compute(self, recipe: Recipe, region: Region | None = None) -> Any:
        self.log.computed.add(recipe.key if region is None else (recipe.key, region))
        self.check()
        if self._progress is not None:
            self._progress(recipe.node)
        with watched(recipe.node):
            if region is not None:
                return recipe.compute_part(self, region)
            shape = None if self.blocks is None else self.blocks.slabs_of(recipe)
            return recipe.compute(self) if shape is None else self._in_slabs(recipe, shape)


class Claims:
    """What an evaluation still needs: values stay until all that is made of them has been made.

    A recipe that is to be made claims what it `needs`; so does each of those in turn, unless its
    value is there already. A claimed value is pinned in the store, whatever its size. Once a recipe
    has been made its claims are given up, and values without another claim may go. Chains of any
    length are followed without recursion. `suffix` follows a recipe's key in the store.
    """

    def __init__(self, store: Store, suffix: str) -> None:
        self._store, self._suffix = store, suffix
        self._lock = threading.RLock()
        self._count: dict[str, int] = {}
        self.waiting: dict[str, tuple[Recipe, ...]] = {}
        """Recipes still to be made, by key, with what each of them claims."""

    def begin(self, recipe: Recipe) -> None:
        """Claim what a recipe needs: it is going to be made."""
        with self._lock:
            if recipe.key not in self.waiting:
                needs = recipe.needs
                self.take(needs)
                self.waiting[recipe.key] = needs

    def settle(self, recipe: Recipe) -> None:
        """Give up what a recipe claims: it has been made, or will not be."""
        with self._lock:
            self.give_up(self.waiting.pop(recipe.key, ()))

    def take(self, recipes: Iterable[Recipe]) -> None:
        """Count a claim on each of these; where one fails, none of them is counted."""
        coming = list(recipes)
        counted: list[str] = []
        begun: set[str] = set()
        with self._lock:
            try:
                while coming:
                    recipe = coming.pop()
                    key = recipe.key
                    claims = self._count.get(key, 0)
                    there = claims > 0 or self._store.pin(key + self._suffix)
                    self._count[key] = claims + 1
                    counted.append(key)
                    if not there and key not in self.waiting and (needs := recipe.needs):
                        self.waiting[key] = needs
                        begun.add(key)
                        coming += needs
            except BaseException:
                for key in begun:
                    del self.waiting[key]
                for key in counted:
                    self._uncount(key)
                raise

    def give_up(self, recipes: Iterable[Recipe]) -> None:
        going = list(recipes)
        with self._lock:
            while going:
                key = going.pop().key
                if self._uncount(key):
                    going += self.waiting.pop(key, ())

    def _uncount(self, key: str) -> bool:
        """Take back one claim, not those on what is needed for it; whether it was the last."""
        self._count[key] -= 1
        if self._count[key]:
            return False
        del self._count[key]
        self._store.unpin(key + self._suffix)
        return True
