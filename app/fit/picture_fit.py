"""A network fitted to pictures: their edges and noise measured, the free parameters found."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from app.fit import chain_transfer
from app.fit.chain_fit import EdgeProblem, Watch, fit_chain
from app.fit.chain_transfer import FreeParameter
from app.fit.edge_fit import Patch, patch_of
from app.fit.fit_result import FitResult, NoiseComparison, result_of
from app.measure.measurement_text import file_warnings, in_words
from app.measure.measuring import refuse_small
from app.measure.picture_measurement import (
    WITH_LOSS,
    PictureFile,
    common_limits,
    open_picture,
    picture_name,
)
from app.tradeoff.tradeoff_results import with_value
from core.arrays import Matrix
from core.chain.engine import Engine, Plan
from core.chain.wires import Image
from core.errors import FAULTS, DataError, several
from core.evaluation.work import Work
from core.network.network import Network
from core.physics.measurement.edge_search import find_edges
from core.physics.measurement.found_edge import missing_samples
from core.physics.measurement.picture_noise import noise_of_picture
from core.physics.measurement.sample_noise import LevelVariance
from core.records import replace

_MOST_LEVELS = 24
_SAME_SIZE = 0.02  # of a sample's size, within which two are the same
_NOTHING = 1e-9  # of a variance: what rounding makes where there is none


def _unlike(file: PictureFile, final: Image) -> list[str]:
    """In what the chain's final picture is not of that picture's camera, as warnings."""
    name = Path(file.name).name if file.samples is None else file.name
    lines = []
    own, chain = file.band_um, final.band_um
    if own and chain and (own[0] > chain[1] or chain[0] > own[1]):
        lines.append(
            f"the picture {name} was taken in the band {own[0]:.4g} to {own[1]:.4g} µm, "
            f"but the chain covers {chain[0]:.4g} to {chain[1]:.4g} µm: the fitted values do "
            "not describe the picture's camera. Change the chain's band, or fit a picture "
            "taken in the chain's band"
        )
    for way, mine, other in (
        ("wide", file.interval_x_mrad, final.interval_x_mrad),
        ("high", file.interval_y_mrad, final.interval_y_mrad),
    ):
        if mine and other and abs(mine / other - 1.0) > _SAME_SIZE:
            lines.append(
                f"a sample of {name} is {mine:.4g} mrad {way}, but a sample of the "
                f"chain's final picture is {other:.4g} mrad: the fitted values are wrong by "
                f"a factor of about {mine / other:.3g}. Set the chain's geometry to match the "
                "camera"
            )
    return lines


def opened_pictures(
    paths: Sequence[Path], *, band: int | None = None, instead: str = ""
) -> list[PictureFile]:
    """Files to fit to, whose frames may differ in size; of a file of bands one of them."""
    opened = [open_picture(path, band=band, instead=instead) for path in paths]
    for file in opened:
        if file.is_lossy:
            raise DataError(
                f"{file.name}: {WITH_LOSS}, so it cannot be fitted. Give a picture that the camera "
                "stored without lossy compression"
            )
        refuse_small(file.name, file.rows, file.columns)
    return opened


def fit_pictures(
    engine: Engine,
    plan: Plan,
    work: Work,
    *,
    free: Sequence[FreeParameter],
    pictures: Sequence[PictureFile],
    report: Callable[[str], None] = lambda _text: None,
    watch: Watch | None = None,
) -> FitResult:
    samples = [picture for file in pictures for picture in file.pictures()]
    clip_levels = common_limits(pictures)
    final = chain_transfer.final_image(plan)
    passed = chain_transfer.transfer_known(final)
    report("edges")
    patches, refused = edges_in(pictures=samples, clip_levels=clip_levels, check=work.check)
    if not patches:
        count = len(samples)
        names = ", ".join(picture_name(pictures, number) for number in range(min(count, 3)))
        raise DataError(
            f"{names}{' …' * (count > 3)}: no edge can be used. {_reasons(refused, 0)}. For "
            "advice, run imagechain handbook edge_pictures"
        )
    report("noise")
    noise, why_none = _noise(engine, plan, work, samples)
    report("parameters")
    problem = EdgeProblem(engine, plan, work, free, patches, noise)
    problem.watch = watch
    fit = fit_chain(problem)
    result = result_of(fit, problem.cost)
    comparison: NoiseComparison | str = why_none
    if noise is not None:
        comparison = _compared(noise, problem.plan(fit.values), problem)
    unlike = (line for file in pictures for line in _unlike(file, final))
    warnings = (*file_warnings(pictures), *unlike, *result.warnings)
    fitted = engine.plan(
        fitted_network(plan.network, result, engine), folder=plan.folder, previous=plan
    )
    warnings += tuple(map(str, fitted.warnings()))
    notes = _notes(len(patches), refused, final, passed_area=chain_transfer.has_area(passed))
    return replace(result, noise=comparison, warnings=warnings, notes=tuple(notes))


def fitted_network(network: Network, result: FitResult, engine: Engine) -> Network:
    for parameter, one in zip(result.fit.free, result.parameters, strict=True):
        if one.used is not None:
            network = with_value(network, engine, parameter.node, parameter.name, one.used)
    return network


def _noise(
    engine: Engine, plan: Plan, work: Work, pictures: Sequence[Matrix]
) -> tuple[chain_transfer.NoiseProblem | None, str]:
    try:
        measured: list[LevelVariance] = []
        reason = ""
        for picture in pictures:
            missing = missing_samples(picture=picture)
            seen = noise_of_picture(picture=picture, avoid=missing, check=work.check)
            measured += seen.levels
            reason = reason or seen.sigma_reason
        if not measured:
            reason = reason or "no area is flat"
            return None, f"the noise of the picture is not known: {reason}"
        measured = sorted(measured, key=lambda one: -one.samples)[:_MOST_LEVELS]
        noise = chain_transfer.NoiseProblem(engine, plan, work, measured)
        noise.predicted(plan)
    except FAULTS as error:
        return None, f"the network's noise is not compared: {error}"
    return noise, ""


def _compared(
    noise: chain_transfer.NoiseProblem, plan: Plan, problem: EdgeProblem
) -> NoiseComparison | str:
    try:
        predicted = noise.predicted(plan)
    except FAULTS as error:
        return f"the network's noise is not compared: {error}"
    measured = np.array([one.variance for one in noise.measured])
    if not np.any(predicted > _NOTHING * measured):
        return "the network adds no noise, so there is nothing to compare the picture's noise with"
    return NoiseComparison(tuple(noise.measured), tuple(map(float, predicted)), bool(problem.noisy))


def _notes(many: int, refused: Sequence[str], final: Image, *, passed_area: bool) -> list[str]:
    lines = [f"{several(many, 'edge')} fitted"]
    if refused:
        lines[0] += f"; {_reasons(refused, many)}"
    x, y = final.interval_x_mrad, final.interval_y_mrad
    if x is not None and y is not None:
        lines.append(
            f"a sample of the picture is assumed to be {x:.4g} × {y:.4g} mrad, like a sample of "
            "the network's final picture: fitted angles and lengths depend on this"
        )
    if passed_area:
        lines.append(
            "a scene sample's area is used as the pixel area: the chain combines scene samples "
            "into pixels, or has no detector that averages over an area"
        )
    return lines


# The edges of a picture that a chain is fitted to.

_MOST_EDGES = 40
_MOST_SAMPLES = 60_000


def _reasons(refused: Sequence[str], used: int) -> str:
    """Why candidates were refused, the clearest first, in one line."""
    if not refused:
        return "No straight edge was found"
    whole = several(len(refused) + used, "candidate")
    return f"{len(refused)} of {whole} rejected: {in_words(refused)}"


def edges_in(
    *,
    pictures: Sequence[Matrix],
    clip_levels: tuple[float, float] | None = None,
    check: Callable[[], None] = lambda: None,
) -> tuple[list[Patch], list[str]]:
    """Samples of the clearest edges in pictures, and why every other candidate is not used."""
    usable: list[tuple[float, Patch]] = []
    refused: list[str] = []
    for number, picture in enumerate(pictures):
        for edge in find_edges(picture=picture, clip_levels=clip_levels, check=check):
            if not edge.used:
                refused.append(edge.why_not)
                continue
            where = f" of picture {number + 1}" if len(pictures) > 1 else ""
            name = f"edge at x {edge.x:.0f}, y {edge.y:.0f}{where}"
            made = patch_of(picture=picture, edge=edge, name=name)
            if isinstance(made, str):
                refused.append(made)
            else:
                # A picture without noise still has the rounding of its numbers.
                noise = max(edge.noise_sigma, made.least_variance**0.5)
                usable.append((edge.contrast / noise * len(made.value) ** 0.5, made))
    usable.sort(key=lambda pair: -pair[0])
    chosen: list[Patch] = []
    samples = 0
    for _, patch in usable[:_MOST_EDGES]:
        if chosen and samples + len(patch.value) > _MOST_SAMPLES:
            break
        chosen.append(patch)
        samples += len(patch.value)
    return chosen, refused
