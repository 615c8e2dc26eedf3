"""Whether a network's recipes can be made in blocks, and which of their pictures lie on disk.

Found from the recipes alone, before anything is computed.
"""

from collections.abc import Iterable, Iterator, Mapping

from core.chain.back_transformed import Delivered
from core.chain.engine import Plan
from core.chain.wires import Image
from core.errors import DataError
from core.evaluation.recipes import Recipe, Step, furthest_first
from core.evaluation.work import BlockRun, Policy, Shape
from core.machine import amount_text
from core.scratch import ScratchDisk

IN_MEMORY_AT_ONCE = 8
"""Pictures of the largest size that a run in memory may hold, with what its steps make besides."""


def largest_picture(plan: Plan, policy: Policy) -> tuple[Shape, int]:
    """The largest picture that is planned, and the memory it takes; empty without any."""
    shapes = {value.shape for value in _images(plan)}
    rows, columns = max(shapes, key=lambda shape: shape[0] * shape[1], default=(0, 0))
    return (rows, columns), rows * columns * policy.dtype.itemsize * IN_MEMORY_AT_ONCE


def planned_blocks(
    plan: Plan, recipes: Iterable[Recipe], disk: ScratchDisk, policy: Policy
) -> BlockRun:
    """What a run in blocks keeps on disk, where it reads the values of all these recipes.

    Raises `DataError` on the first node that would take or make a picture as a whole that has to
    lie on disk.
    """
    pictures = {value.key: value.shape for value in _images(plan)}
    on_disk: dict[str, Shape] = {}
    for recipe in _furthest_first(recipes):
        shape = _shape(recipe, pictures)
        if shape is not None:
            pictures[recipe.key] = shape
            if disk.wants(shape, policy.dtype):
                on_disk[recipe.key] = shape
        large = [on_disk[one.key] for one in recipe.inputs if one.key in on_disk]
        if recipe.key in on_disk:
            large.append(on_disk[recipe.key])
        held = recipe.held_size
        if held is not None and not disk.wants(held, policy.dtype):
            continue
        if large and not recipe.in_blocks:
            raise _refusal(recipe, max(large), disk)
    return BlockRun(disk, on_disk)


def least_scratch(recipes: Iterable[Recipe], blocks: BlockRun, policy: Policy) -> int:
    """Bytes that lie on disk at a time at least: a picture that is filtered, and its spectrum."""
    most = 0
    for recipe in _furthest_first(recipes):
        if isinstance(recipe, Delivered) and recipe.magnitude.image is not None:
            size = recipe.magnitude.grid.rows * recipe.magnitude.grid.columns
            if recipe.magnitude.image.key in blocks.shapes:
                most = max(most, 2 * size * policy.dtype.itemsize)
    return most


def _refusal(recipe: Recipe, shape: Shape, disk: ScratchDisk) -> DataError:
    error = DataError(
        f"{_what(recipe)} cannot run in blocks, and the whole picture of {shape[0]} × {shape[1]} "
        f"samples does not fit in {amount_text(disk.memory_bytes)} of memory. Raise the memory "
        "limit, or leave the node out",
        hint="raise the memory limit with --memory",
    )
    return error if recipe.node is None else error.at(recipe.node)


def _what(recipe: Recipe) -> str:
    if isinstance(recipe, Delivered):
        if not recipe.one_source:
            return "combining the magnitude of one picture with the phase of another"
        if recipe.sampled is not None and not recipe.sampled.folds:
            return "sampling with a pixel pitch that is not a whole number of samples"
        return "filtering every band at its own wavelength"
    name = recipe.in_words or type(recipe).__name__
    if isinstance(recipe, Step):
        name = getattr(recipe.function, "__name__", name)
    return name.strip("_").replace("_", " ")


def _shape(recipe: Recipe, known: Mapping[str, Shape]) -> Shape | None:
    """Size of a picture; None for all that is none. What it is made of is known."""
    if recipe.key in known:
        return known[recipe.key]
    if isinstance(recipe, Delivered):
        if recipe.sampled is not None:
            return recipe.sampled.new
        grid = recipe.magnitude.grid
        return grid.rows // recipe.factor_y, grid.columns // recipe.factor_x
    if not isinstance(recipe, Step) or not recipe.in_parts:
        return None
    how = dict(recipe.parameters)
    given = how.get("shape")
    if {"old", "factor_y", "factor_x"} <= how.keys():  # pixels combined inside a node
        given = how["old"][0] // how["factor_y"], how["old"][1] // how["factor_x"]
    if given is not None:
        return int(given[0]), int(given[1])
    sizes = [known[one.key] for one in recipe.inputs if one.key in known]
    return max(sizes, default=None)  # patterns of one line are spread over the picture


def _images(plan: Plan) -> list[Image]:
    outputs = (value for node in plan.nodes.values() for value in node.outputs.values())
    return [value for value in outputs if isinstance(value, Image)]


def _furthest_first(recipes: Iterable[Recipe]) -> Iterator[Recipe]:
    """All that recipes are made of, and they themselves, each after what it is made of."""
    done: set[str] = set()
    for recipe in furthest_first(recipes, lambda one: one.inputs, lambda one: one.key in done):
        done.add(recipe.key)
        yield recipe
