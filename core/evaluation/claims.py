"""What an evaluation still needs: values stay until all that is made of them has been made.

A recipe that is to be made claims what it `needs`; so does each of those in turn, unless its value
is there already. A claimed value is pinned in the store, whatever its size. Once a recipe has been
made its claims are given up, and values without another claim may go. Chains of any length are
followed without recursion.
"""

from __future__ import annotations

import threading
from collections.abc import Iterable
from types import TracebackType
from typing import TYPE_CHECKING

from core.evaluation.store import Store

if TYPE_CHECKING:
    from core.evaluation.recipes import Recipe


class Claims:
    """The claims of one evaluation; safe to share between threads.

    Parameters
    ----------
    store : Store
        Where the values are.
    suffix : str
        What follows a recipe's key there.
    """

    def __init__(self, store: Store, suffix: str) -> None:
        self._store, self._suffix = store, suffix
        self._lock = threading.Lock()
        self._count: dict[str, int] = {}
        self.waiting: dict[str, tuple[Recipe, ...]] = {}
        """Recipes still to be made, by key, with what each of them claims."""

    def begin(self, recipe: Recipe) -> None:
        """Claim what a recipe needs: it is going to be made."""
        with self._lock:
            if recipe.key not in self.waiting:
                needs = recipe.needs
                self._take(needs)
                self.waiting[recipe.key] = needs

    def settle(self, recipe: Recipe) -> None:
        """Give up what a recipe claims: it has been made, or will not be."""
        with self._lock:
            self._give_up(self.waiting.pop(recipe.key, ()))

    def take(self, recipes: Iterable[Recipe]) -> None:
        """Claim values that will be read later."""
        with self._lock:
            self._take(recipes)

    def give_up(self, recipes: Iterable[Recipe]) -> None:
        """Take back as many claims."""
        with self._lock:
            self._give_up(recipes)

    def _take(self, recipes: Iterable[Recipe]) -> None:
        """Count a claim on each of these; where one fails, none of them is counted."""
        coming = list(recipes)
        counted: list[str] = []
        begun: set[str] = set()
        try:
            while coming:
                recipe = coming.pop()
                key = recipe.key
                claims = self._count.get(key, 0)
                there = claims > 0 or self._store.pin(key + self._suffix)
                self._count[key] = claims + 1
                counted.append(key)
                if there or key in self.waiting:
                    continue
                needs = recipe.needs
                if needs:
                    self.waiting[key] = needs
                    begun.add(key)
                    coming += needs
        except BaseException:
            self._uncount(counted)
            for key in begun:
                del self.waiting[key]
            raise

    def _uncount(self, keys: Iterable[str]) -> None:
        """Take back one claim on each of these alone, not on what it needs."""
        for key in keys:
            self._count[key] -= 1
            if not self._count[key]:
                del self._count[key]
                self._store.unpin(key + self._suffix)

    def _give_up(self, recipes: Iterable[Recipe]) -> None:
        going = list(recipes)
        while going:
            key = going.pop().key
            claims = self._count[key] - 1
            if claims:
                self._count[key] = claims
                continue
            del self._count[key]
            self._store.unpin(key + self._suffix)
            going += self.waiting.pop(key, ())


class Held:
    """Values held for reads to come, until each has been released or the block ends."""

    def __init__(self, claims: Claims, recipes: Iterable[Recipe]) -> None:
        self._claims = claims
        self._left: dict[str, list[Recipe]] = {}
        for recipe in recipes:
            self._left.setdefault(recipe.key, []).append(recipe)
        claims.take([recipe for alike in self._left.values() for recipe in alike])

    def release(self, recipes: Iterable[Recipe]) -> None:
        """Each of these has been read once."""
        self._claims.give_up([self._left[recipe.key].pop() for recipe in recipes])

    def __enter__(self) -> Held:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        raised: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Release all that is left."""
        left, self._left = self._left, {}
        self._claims.give_up([recipe for alike in left.values() for recipe in alike])
