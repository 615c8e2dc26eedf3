"""What an evaluation did not compute, and why: an account by node, for people.

It is read off the plan and the evaluation's tally; nothing that is computed depends on it.
"""

from collections.abc import Iterator
from typing import Any, Literal

from core.chain.back_transformed import Delivered, DeliveredBands
from core.chain.engine import Plan, PlannedNode
from core.chain.wires import Curve, Image, Pupil, SpectrumWire, Table, Transfer
from core.errors import several
from core.evaluation.recipes import Recipe, Step
from core.evaluation.work import Work
from core.records import dataclass, replace

Kind = Literal[
    "disabled", "identity", "below_budget", "unseen", "unchanged", "region", "wavelengths"
]


@dataclass(frozen=True)
class Skip:
    """Something of a node that was not computed.

    Kinds: ``disabled``; ``identity``, a setting that changes nothing; ``below_budget``, a stage
    left out; ``unseen``, outputs (`ports`) that were not requested; ``unchanged``, values that were
    there already; ``region``, a picture of which only a region was wanted; ``wavelengths``, bands
    for which other wavelengths stand.

    `bound` is the most that a stage or wavelengths left out could change, as a fraction of the
    picture's range; `share` the part that was computed after all. `text` has neither.
    """

    node: str
    kind: Kind
    text: str
    bound: float | None = None
    share: float | None = None
    ports: tuple[str, ...] = ()


def skips(plan: Plan, work: Work) -> tuple[Skip, ...]:
    """Everything an evaluation has skipped so far, node by node in the plan's order."""
    account = _Account(work)
    skips_by_node: dict[str, list[Skip]] = {name: [] for name in plan.nodes}
    for name, planned in plan.nodes.items():
        for skip in account.of_node(name, planned):
            if skip.node in skips_by_node:  # a factor may name a stage that is no node
                skips_by_node[skip.node].append(skip)
    return tuple(skip for skips_of in skips_by_node.values() for skip in _strongest(skips_of))


class _Account:
    """What one evaluation requested, and what of it need not have been."""

    def __init__(self, work: Work) -> None:
        self.work = work
        self.requested, self.computed = {**work.log.requested}, {*work.log.computed}
        reused = work.log.reused()
        behind = _behind(reused)
        self.parts = {**work.log.parts}
        self._steps: dict[str | None, list[str]] = {}
        for key, recipe in self.requested.items():
            self._steps.setdefault(recipe.node, []).append(key)
        parts = (key for key, _ in self.parts)
        self.known = behind.union(self.requested, work.log.looked_at, parts)
        self.was_there = behind.union(recipe.key for recipe in reused)

    def of_node(self, name: str, planned: PlannedNode) -> Iterator[Skip]:
        if planned.node.disabled:
            yield Skip(name, "disabled", "disabled: the input is passed on")
            return
        if planned.is_neutral:
            yield Skip(name, "identity", "the settings change nothing: the input is passed on")
            return
        made = _made(planned)
        keys = {port: _key(value) for port, value in made.items()}
        unseen = tuple(port for port, key in keys.items() if key not in self.known)
        if unseen:
            text = f"{', '.join(unseen)} not requested, so not computed as a full array"
            yield Skip(name, "unseen", text, ports=unseen)
        yield from self._unchanged(name, set(keys.values()))
        for value in made.values():
            if isinstance(value, Image):
                yield from self._of_regions(name, value)
            recipe = self._delivered(value)
            if recipe is not None:
                yield from self._of_picture(name, recipe)

    def _delivered(self, value: Any) -> Delivered | None:
        """The inverse transform that made a picture, or another sum of its bands."""
        recipe = getattr(value, "recipe", None)
        if isinstance(recipe, Delivered) and recipe.key in self.known:
            return recipe
        bands = getattr(value, "bands", None)
        if not isinstance(bands, DeliveredBands):
            return None
        sums = (one for one in self.requested.values() if isinstance(one, Delivered))
        alike = (one for one in sums if replace(one, weights=None).key == bands.delivered.key)
        return next(alike, None)

    def _unchanged(self, name: str, keys: set[str]) -> Iterator[Skip]:
        steps = self._steps.get(name, [])
        reused = [key for key in steps if key not in self.computed]
        if len(reused) < len(steps) and reused:
            text = f"{len(reused)} of {len(steps)} steps unchanged and reused"
        elif reused or (not steps and keys & self.was_there):
            text = "unchanged: the node's values were reused"
        else:
            return
        share = (len(steps) - len(reused)) / len(steps) if steps else 0.0
        yield Skip(name, "unchanged", text, share=share)

    def _of_regions(self, name: str, image: Image) -> Iterator[Skip]:
        """What was made of a picture for a region of it, and of the pictures it takes."""
        maker = image.recipe.node or name
        shares = []
        for (key, region), recipe in self.parts.items():
            if recipe.node == maker and key in self.requested:
                shares += [1.0] if key in self.computed else []
            elif recipe.node == maker and (key, region) in self.computed:
                shares.append(recipe.share(region, image.shape))
        for key, region in self.parts if shares else ():
            if key == image.key:
                alone = sum(share < 1 for share in shares)
                made = f": {alone} of {len(shares)} steps computed only the samples needed"
                text = (
                    f"{region.columns} × {region.rows} of {image.columns} × {image.rows} samples "
                    f"were needed{made if alone else ', but the whole picture was computed'}"
                )
                yield Skip(maker, "region", text, share=sum(shares) / len(shares))

    def _of_picture(self, name: str, recipe: Delivered) -> Iterator[Skip]:
        """What was skipped to make a picture that comes out of an inverse transform."""
        rank = recipe.rank(self.work)
        if rank is not None and rank.bound > 0.0:
            count, every = rank.shares.shape
            text = f"transforms of {several(count, 'wavelength')} represent {every} bands"
            yield Skip(
                recipe.node or name, "wavelengths", text, bound=rank.bound, share=count / every
            )
        for stage, bound in recipe.spent(self.work)[1]:
            text = f"{stage.label or 'the stage'} left out: its effect is below the error budget"
            yield Skip(stage.node or "", "below_budget", text, bound=bound)


def _made(planned: PlannedNode) -> dict[str, Any]:
    """Outputs that something would have to be computed for, less what is passed on."""
    given = {getattr(value, "key", None) for value in planned.inputs.values()}
    return {
        port: value
        for port, value in planned.outputs.items()
        if isinstance(value, Image | Curve | Table | Pupil | Transfer | SpectrumWire)
        and value.key not in given
        and not (isinstance(value, Transfer) and not value.factors and value.own is None)
    }


def _key(value: Any) -> str:
    """Key under which an evaluation notes that a port's value was requested."""
    if isinstance(value, Pupil):
        return value.samples.key
    if isinstance(value, Transfer) and value.own is not None:
        return value.own.key
    key: str = value.key
    return key


def _behind(recipes: list[Recipe]) -> set[str]:
    keys: set[str] = set()
    waiting = list(recipes)
    while waiting:
        recipe = waiting.pop()
        needed = list(recipe.inputs)
        if isinstance(recipe, Step):
            wires = (value for _, value in recipe.parameters if isinstance(value, SpectrumWire))
            needed += [wire.image.recipe for wire in wires if wire.image is not None]
        waiting += [one for one in needed if one.key not in keys]
        keys.update(one.key for one in needed)
    return keys


def _strongest(skips_of_node: list[Skip]) -> Iterator[Skip]:
    """Of skips listed more than once, as in several pictures, the largest bound or share."""
    best: dict[tuple[str, str], Skip] = {}
    for skip in skips_of_node:
        other = best.setdefault((skip.kind, skip.text), skip)
        if (skip.bound or 0, skip.share or 0) > (other.bound or 0, other.share or 0):
            best[skip.kind, skip.text] = skip
    yield from best.values()
