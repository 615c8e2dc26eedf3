"""``imagechain fit``: the parameters of a chain with which it gives the edges of a real picture."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from app.command.run import input_files, open_network, policy_of
from app.fit.chain_fit import EdgeProblem, fit_chain
from app.fit.chain_transfer import ChainAt, final_image, transfer_known
from app.fit.edges_in_picture import EdgeChoice, edges_in
from app.fit.fit_json import fit_json
from app.fit.fit_result import FitResult, result_of
from app.fit.free_parameter import free_parameters
from app.measure.picture_loading import PictureFile, open_picture
from app.options.command_options import Options
from app.options.progress import Progress
from app.run.readout_tables import columns, number_text
from app.run.shipped import find_network
from app.run.staging import Staging
from app.tradeoff.evaluated_points import with_value
from core.atomic import write_text
from core.chain.engine import Engine
from core.errors import DataError
from core.names import in_line
from core.network.file import format_network
from nodes.library import standard_library


def fit_network(options: Options, cancel: threading.Event | None = None) -> None:
    """Carry out the command; prints the parameters when all is written.

    Parameters
    ----------
    options : Options
        What the command line gives.
    cancel : threading.Event, optional
        Set to stop before the next evaluation.

    Raises
    ------
    ImagechainError
        The first fault; nothing has been written then.
    """
    library = standard_library()
    place = find_network(options.network)
    network = open_network(place, options, library)
    free = free_parameters(options.free, network, library)
    engine = Engine(library)
    plan = engine.plan(network, folder=place.folder)
    work = engine.work(policy_of(options), cancel=cancel)
    transfer_known(final_image(plan))
    inputs = [place.path, *options.pictures, *input_files(plan, place.folder)]
    with Staging(None, inputs) as staging:
        for path in filter(None, (options.fit_json, options.fit_output)):
            staging.claim(path)
        with Progress(3) as progress:
            progress("edges")
            choice = _edges(options.pictures, work.check)
            progress("parameters")
            chain = ChainAt(engine, plan, [parameter.target for parameter in free])
            problem = EdgeProblem(chain, work, free, choice.patches)
            result = result_of(fit_chain(problem), problem.cost)
        if options.fit_json is not None:
            staging.write(options.fit_json, partial(write_text, content=fit_json(result)))
        if options.fit_output is not None:
            fitted = network
            for parameter, one in zip(free, result.parameters, strict=True):
                if one.used is not None:
                    fitted = with_value(fitted, engine, parameter.node, parameter.name, one.used)
            text = format_network(fitted, library=library)
            staging.write(options.fit_output, partial(write_text, content=text))
        staging.commit()
    _print(result)


def _edges(paths: tuple[Path, ...], check: Callable[[], None]) -> EdgeChoice:
    """The edges of pictures that may differ in size."""
    files = [open_picture(path) for path in paths]
    pictures = [picture for file in files for picture in file.pictures()]
    choice = edges_in(pictures=pictures, clip_levels=_limits(files), check=check)
    if not choice.patches:
        raise DataError(f"{_listed(paths)}: no edge can be used: {choice.reasons}")
    return choice


def _limits(files: Sequence[PictureFile]) -> tuple[float, float] | None:
    limits = [file.limits for file in files if file.limits is not None]
    return limits[0] if limits else None


def _listed(paths: tuple[Path, ...]) -> str:
    return ", ".join(map(str, paths[:3])) + (" …" if len(paths) > 3 else "")


def _print(result: FitResult) -> None:
    rows = [
        (
            one.port,
            number_text(one.value),
            "" if one.sigma is None else f"± {number_text(one.sigma)}",
            one.unit,
        )
        for one in result.parameters
    ]
    print(columns(rows, right=(1,)), end="\n\n")
    misfit = result.fit.misfit
    print(
        f"chi² per degree of freedom  {number_text(result.chi2_per_degree)}  "
        f"({misfit.degrees} degrees, {len(result.fit.patches)} edges)"
    )
    for line in result.notes:
        print(in_line(line))
    for line in result.warnings:
        print(in_line(f"warning: {line}"))
