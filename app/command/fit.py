"""``imagechain fit``: the parameters of a chain with which it gives the edges of a real picture."""

from __future__ import annotations

import threading
from functools import partial

from app.command.results import Progress, show
from app.command.run import input_files, opened, policy_of
from app.fit.fit_page import fit_facts, fit_page, fit_text
from app.fit.free_parameter import free_parameters
from app.fit.picture_fit import fit_known_scene, fit_pictures, read_pictures
from app.options.command_options import Options
from app.run.readout_tables import json_text
from app.run.staging import Staging
from app.tradeoff.tradeoff_results import with_value
from core.atomic import write_text
from core.chain.engine import Engine
from core.editing.document import rebased
from core.network.file import format_network


def carry_out(options: Options, stop: threading.Event) -> None:
    library, place, network = opened(options)
    free = free_parameters(options.free, network, library)
    engine = Engine(library)
    plan = engine.plan(network, folder=place.folder)
    work = engine.work(policy_of(options), cancel=stop)
    inputs = [place.path, *options.pictures, *input_files(plan, place.folder)]
    with Staging(None, inputs) as staging:
        for path in filter(None, (options.json_file, options.output, options.report)):
            staging.claim(path)
        with Progress(3) as progress:
            fit = fit_known_scene if options.known_scene else fit_pictures
            result = fit(
                engine,
                plan,
                work,
                free=free,
                pictures=read_pictures(options.pictures, band=options.band),
                report=progress,
            )
        if options.json_file is not None:
            text = json_text(fit_facts(result))
            staging.write(options.json_file, partial(write_text, content=text))
        if options.output is not None:
            fitted = network
            for parameter, one in zip(free, result.parameters, strict=True):
                if one.used is not None:
                    fitted = with_value(fitted, engine, parameter.node, parameter.name, one.used)
            typed = {(setting.node, setting.name) for setting in options.settings}
            moved = rebased(fitted, library, place.folder, options.output.parent, typed=typed)
            text = format_network(moved.apply(fitted) if moved else fitted, library=library)
            staging.write(options.output, partial(write_text, content=text))
        if options.report is not None:
            names = tuple(map(str, options.pictures))
            page = fit_page(result, network=network.name or place.name, pictures=names)
            staging.write(options.report, partial(write_text, content=page))
        staging.commit()
    show(options, lambda: fit_facts(result), fit_text(result))
