"""What the engine relies on in any module: those who write one run it over theirs.

Whether its physics is right is for its own tests.
"""

import json
import math
import pickle
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from core.chain.engine import Engine, Plan
from core.chain.noise_power import NoisePower
from core.chain.wires import CurveData, Image, TableData, Transfer, transfer_plane
from core.errors import ImagechainError, NetworkError, ParameterError
from core.evaluation.recipes import Recipe, Region, Step
from core.evaluation.work import Policy, Work
from core.modules.declaration import Declaration, Module, declaration
from core.modules.parameters import Parameter, plain
from core.network.network import Link, Network, Node
from core.records import dataclass, replace
from core.transfer.factors import Product
from nodes.library import standard_library

Params = Mapping[str, Any]
XI = np.concatenate([[0.0], np.geomspace(1e-3, 40.0, 15)])
ETA = np.concatenate([[0.0], np.geomspace(2e-3, 30.0, 11)])
SINGLE_ERROR = 2e-5  # of the range: what single precision may make of a chain
DOUBLE_ERROR = 1e-12
DOUBLE = Policy(precision="double")
WARMER_K = 320.0
GAIN_ERROR = 0.01


def check_module(module: type[Module], **how: Any) -> None:
    """Raise `AssertionError` with every fault of a module; parameters as for `faults_of`."""
    faults = faults_of(module, **how)
    assert not faults, "\n".join([f"{module.__name__}:", *faults])


def faults_of(
    module: type[Module],
    *,
    examples: Sequence[Params] = ({},),
    scene: Params = MappingProxyType({}),
    passive: bool = True,
    folder: Path | None = None,
) -> list[str]:
    """What does not hold of a module, each in one line.

    The `examples` are parameters with which it runs, as in a network's file; `scene` parameters of
    the *Test Scene* that it is given. A `passive` transfer function is 1 at zero and nowhere above
    1. Files that the examples name lie in `folder`.
    """
    try:
        declared = declaration(module)
    except TypeError as error:
        return [f"declaration: {error}"]
    faults = list(_of_declaration(declared))
    for parameter in declared.parameters:
        faults += _safely(parameter.name, partial(_of_parameter, module, parameter))
    with tempfile.TemporaryDirectory() as empty:
        for params in examples:
            trial = _Trial(module, dict(params), scene, folder or Path(empty))
            name = json.dumps(trial.params, ensure_ascii=False)
            checks = [_of_values, _of_precision, _of_regions, _of_keys, _of_steps, _of_gain]
            checks += [_of_noise, _of_readouts]
            for check in checks:
                faults += _safely(name, partial(check, trial))
            faults += _safely(name, partial(_of_transfer, trial, passive))
    return list(dict.fromkeys(faults))


@dataclass(frozen=True)
class _Trial:
    module: type[Module]
    params: Params
    scene: Params
    folder: Path

    def planned(self, **changes: Any) -> tuple[Engine, Plan]:
        return planned(self.module, {**self.params, **changes}, self.scene, self.folder)

    def in_double(self) -> tuple[Engine, Plan, Work, Mapping[str, Any]]:
        engine, plan = self.planned()
        return engine, plan, engine.work(DOUBLE), plan.nodes[IT].outputs

    def values(self, policy: Policy, **changes: Any) -> dict[str, Any]:
        engine, plan = self.planned(**changes)
        work = engine.work(policy)
        return {name: engine.value(plan, f"{IT}.{name}", work) for name in plan.nodes[IT].outputs}


def _safely(name: str, check: Callable[[], Iterable[str]]) -> list[str]:
    """Faults, each with what it is of; an exception is one of them."""
    try:
        return [f"{name}: {fault}" for fault in check()]
    except ImagechainError as error:
        return [f"{name}: does not run: {error}"]
    except Exception as error:  # whatever code of others may raise
        return [f"{name}: raises {type(error).__name__} instead of an ImagechainError: {error}"]


def _of_declaration(declared: Declaration) -> Iterator[str]:
    if not declared.text:
        yield "help: the class has no docstring"
    if len(declared.title) > 40:
        yield f"title: {len(declared.title)} characters do not fit on a node; at most 40 do"
    for parameter in declared.parameters:
        if not parameter.param.text:
            yield f"{parameter.name}: has no help text"
        elif parameter.param.text.rstrip().endswith("."):
            yield f"{parameter.name}: the help text must not end with a full stop"
    for readout in declared.readouts:
        if not readout.meaning:
            yield f"read-out {readout.name}: its method has no docstring"


def _of_parameter(module: type[Module], parameter: Parameter) -> Iterator[str]:
    if not parameter.required:
        stored = json.loads(json.dumps(plain(parameter.default)))
        if parameter.coerce(stored) != parameter.default:
            yield "the parameter's default changes when it is saved to a file and read back"
    if parameter.kind not in ("number", "integer"):
        return
    param = parameter.param
    outside: list[Any] = [math.nan, math.inf, -math.inf, "no number"]
    outside += [] if param.low is None else [param.low - 1]
    outside += [] if param.high is None else [param.high + 1]
    if parameter.empty and param.zero_is_empty and 0 in outside:
        outside.remove(0)  # an empty number
    for value in outside:
        try:
            module.build({parameter.name: value})
        except ParameterError as error:
            if "\n" in str(error):
                yield f"the error message for {value} has more than one line"
        else:
            yield f"the value {value} is accepted but should be refused"


def _of_values(trial: _Trial) -> Iterator[str]:
    engine, plan, work, outputs = trial.in_double()
    for name, wire in outputs.items():
        value = engine.value(plan, f"{IT}.{name}", work)
        if not _finite(value):
            yield f"output {name} is not finite"
        if isinstance(wire, Image) and isinstance(value, np.ndarray):
            if value.shape != wire.shape:
                yield f"output {name} has the shape {value.shape}, but declares {wire.shape}"
            if value.flags.writeable:
                yield f"output {name} can be modified: return a read-only array"
        if pickle.loads(pickle.dumps(wire)).key != wire.key:
            yield f"output {name} has a different key after being sent to another process"


def _of_precision(trial: _Trial) -> Iterator[str]:
    if trial.module.draws_noise:
        return  # deviates need not be alike
    single, double = (trial.values(Policy(precision=name)) for name in ("single", "double"))
    known = {
        name: values
        for name, values in double.items()
        if isinstance(values, np.ndarray) and np.isrealobj(values) and np.isfinite(values).all()
    }
    # A difference of pictures is as good as these are.
    widest = max((float(np.ptp(values)) for values in known.values()), default=0.0)
    for name, exact in known.items():
        if span := widest or float(np.abs(exact).max()):
            error = float(np.abs(single[name] - exact).max()) / span
            if error > SINGLE_ERROR:
                yield (
                    f"output {name} in single precision differs from double precision by "
                    f"{error:.1g} of the range"
                )


def _of_regions(trial: _Trial) -> Iterator[str]:
    engine, plan, work, outputs = trial.in_double()
    for name, wire in outputs.items():
        if not isinstance(wire, Image):
            continue
        whole = engine.value(plan, f"{IT}.{name}", work)
        rows, columns = wire.shape
        span = float(np.ptp(whole)) or 1.0
        for place in ((0, 0, 1, 1), (rows // 2, columns // 3, rows // 3, columns // 2)):
            region, (other, again) = Region(*place), trial.planned()
            part = other.value(again, f"{IT}.{name}", other.work(DOUBLE), region)
            error = float(np.abs(part - whole[region.slices]).max()) / span
            if error > DOUBLE_ERROR:
                yield (
                    f"output {name}: a region computed on its own differs from the full picture by "
                    f"{error:.1g} of the range"
                )


def _of_keys(trial: _Trial) -> Iterator[str]:
    """Equal keys mean equal values, whichever parameter is changed."""
    (_, one), (_, two) = trial.planned(), trial.planned()
    outputs = one.nodes[IT].outputs
    for name, wire in outputs.items():
        if two.nodes[IT].outputs[name].key != wire.key:
            yield f"output {name} has a different key each time it is planned"
    before = trial.values(DOUBLE)
    for parameter in declaration(trial.module).parameters:
        for value in _other_values(parameter, trial.params):
            try:
                _, changed = trial.planned(**{parameter.name: value})
                after = trial.values(DOUBLE, **{parameter.name: value})
            except ImagechainError:
                continue  # refused, or it does not fit the others
            for name in outputs.keys() & after.keys():
                same_key = changed.nodes[IT].outputs[name].key == outputs[name].key
                if same_key and not _same(before[name], after[name]):
                    yield (
                        f"output {name} changes with {parameter.name} = {value}, but its key does "
                        "not: everything that the output depends on must be an argument of the "
                        "recipe"
                    )


def _of_transfer(trial: _Trial, passive: bool) -> Iterator[str]:
    _, _, work, outputs = trial.in_double()
    factors: tuple[Any, ...] = ()
    xi, eta = (np.concatenate([-half[:0:-1], half]) for half in (XI, ETA))
    for name in ("mtf", "ptf"):
        wire = outputs.get(name)
        if not isinstance(wire, Transfer) or wire.own is not None:
            continue
        plane = transfer_plane(work, wire, xi, eta)
        if not np.isfinite(plane).all():
            yield f"{name} is not finite at some frequency"
        factors += tuple(wire.factors)
    if not factors:
        return
    otf = Product(factors).total(work, xi, eta)
    zero = otf[ETA.size - 1, XI.size - 1]
    if np.abs(otf - otf[::-1, ::-1].conj()).max() > 1e-11:
        yield "H(−f) is not the conjugate of H(f): a picture would not stay real"
    if passive and zero != 1.0:
        yield f"H(0) = {zero}, not 1: the mean would change"
    if passive and np.abs(otf).max() > 1.0 + 1e-15:
        yield f"|H| reaches {np.abs(otf).max():.6g}, above 1; set passive=False if intended"


def _of_steps(trial: _Trial) -> Iterator[str]:
    """Of the pictures put out, and of those that they stem from."""
    for wire in trial.in_double()[3].values():
        recipe: Recipe | None = wire.recipe if isinstance(wire, Image) else None
        while recipe is not None:
            if isinstance(recipe, Step) and not callable(getattr(recipe.function, "lineage", None)):
                yield (
                    f"{recipe.function.__qualname__} does not state how it changes a picture: mark "
                    "it with picture_step, source_step or ends_lineage"
                )
            recipe = recipe.lineage and recipe.lineage.picture


def _of_gain(trial: _Trial) -> Iterator[str]:
    """What a step says that it multiplies small differences by, against two scenes."""
    if trial.module.draws_noise:
        return
    warmer = replace(trial, scene={**trial.scene, "temperature_K": WARMER_K})
    means: list[dict[str, float]] = []
    for one in (trial, warmer):
        engine, plan, work, outputs = one.in_double()
        lineages = {n: w.recipe.lineage for n, w in outputs.items() if isinstance(w, Image)}
        scene = plan.output("scene.image").recipe
        known = {
            name: lineage.linear.gain
            for name, lineage in lineages.items()
            if lineage is not None
            and lineage.picture is not None
            and lineage.picture.key == scene.key
            and lineage.linear.level is None
            and not lineage.noise
        }
        values = {name: engine.value(plan, f"{IT}.{name}", work) for name in known}
        means.append({name: float(np.mean(value)) for name, value in values.items()})
        means[-1][""] = float(np.mean(engine.value(plan, "scene.image", work)))
    span = means[1][""] - means[0][""]
    for name, gain in known.items():
        measured = (means[1][name] - means[0][name]) / span
        if abs(measured - gain) > GAIN_ERROR * max(abs(gain), abs(measured)):
            yield (
                f"output {name}: a change in the scene is multiplied by {measured:.4g}, but the "
                f"step states a gain of {gain:.4g}: give the step's linear gain in picture_step"
            )


def _of_noise(trial: _Trial) -> Iterator[str]:
    _, _, work, outputs = trial.in_double()
    for name, wire in outputs.items():
        lineage = wire.recipe.lineage if isinstance(wire, Image) else None
        if lineage is None or lineage.picture is None:
            continue
        rows, columns = lineage.linear.size_before(*wire.shape)
        white = NoisePower.white(rows, columns, 1.0)
        behind = lineage.linear.carried(work, white, temporal=True)
        variance = 0.0 if behind is None else behind.variance
        if not (math.isfinite(variance) and variance >= 0):
            yield (
                f"output {name}: noise of variance 1 gives a variance of {variance}, which must "
                "be finite and not negative"
            )


def _of_readouts(trial: _Trial) -> Iterator[str]:
    engine, plan, work, _ = trial.in_double()
    for name, value in engine.readouts(plan, IT, work).items():
        if not _finite(value):
            yield f"read-out {name} is {value}"


def _other_values(parameter: Parameter, params: Params) -> list[Any]:
    now = params.get(parameter.name, None if parameter.required else plain(parameter.default))
    if parameter.kind == "switch":
        return [not now]
    if parameter.kind == "choice":
        return [choice for choice in parameter.choices if choice != now]
    if parameter.kind not in ("number", "integer"):
        return []
    start = now if isinstance(now, int | float) and now else parameter.param.low or 1.0
    return [round(2 * start) if parameter.kind == "integer" else 1.37 * start]


def _same(one: Any, two: Any) -> bool:
    if isinstance(one, np.ndarray) and isinstance(two, np.ndarray):
        return bool(np.array_equal(one, two))
    return pickle.dumps(one) == pickle.dumps(two)


def _finite(value: Any) -> bool:
    if isinstance(value, np.ndarray):
        return value.size > 0 and bool(np.isfinite(value).all())
    if isinstance(value, CurveData):
        return all(_finite(s.x) and _finite(s.y) for s in value.series)
    if isinstance(value, TableData):
        return all(_finite(row.value) for row in value.rows)
    return math.isfinite(value) if isinstance(value, float) else True


IT = "it"
SENSOR = {
    "focal_length_mm": 50.0, "f_number": 2.0, "detector_x_um": 30.0, "detector_y_um": 30.0,
}  # fmt: skip
SCENE = {"width": 15, "height": 11, "fov_x_deg": 1.5, "fov_y_deg": 1.1}
BASE: Mapping[str, tuple[str, Mapping[str, Any]]] = {
    "scene": ("test_scene", SCENE),
    "init": ("init_trans", SENSOR),
    "pupil": ("exit_pupil", {"size_x": 32, "size_y": 32, "radius": 12}),
    "blur": ("gaussian_mtf", {"sigma_x_mrad": 1.0}),
    "lag": ("charge_eff_phase", {"efficiency": 0.99}),
}
BASE_LINKS = (
    ("scene", "image", "init", "image"),
    ("init", "context", "blur", "context"),
    ("init", "magnitude", "blur", "magnitude"),
    ("init", "context", "lag", "context"),
    ("init", "phase", "lag", "phase"),
)
SOURCES = {
    "image": ("scene", "image"),
    "context": ("init", "context"),
    "magnitude": ("blur", "magnitude"),
    "phase": ("lag", "phase"),
    "pupil": ("pupil", "pupil"),
    "transfer": ("blur", "mtf"),
}


def network_of(
    module: type[Module], params: Mapping[str, Any], scene: Mapping[str, Any]
) -> Network:
    nodes = {
        name: Node(name, key, {**values, **(scene if name == "scene" else {})})
        for name, (key, values) in BASE.items()
    }
    links = [Link(*ends) for ends in BASE_LINKS]
    for port in declaration(module).inputs:
        source = next((SOURCES[kind] for kind in port.types if kind in SOURCES), None)
        if source is not None:
            links.append(Link(*source, IT, port.name))
        elif port.required:
            kinds = " or ".join(port.types)
            raise NetworkError(
                f"the test network has no {kinds} for the input {port.name}", node=IT
            )
    nodes[IT] = Node(IT, module.key, dict(params))
    return Network(nodes=nodes, links=tuple(links), seed=1996)


def planned(
    module: type[Module], params: Mapping[str, Any], scene: Mapping[str, Any], folder: Path
) -> tuple[Engine, Plan]:
    engine = Engine({**standard_library(), module.key: module})
    plan = engine.plan(network_of(module, params, scene), folder=folder)
    for node in plan.nodes.values():
        if node.error is not None:
            raise node.error
    return engine, plan
