"""Published figures, beside those of this run.

A network may carry two fields for it. `published` is a list of objects with `figure`, `where`,
`value`, `unit`, `from`, `within` and `reason`: `from` names the figure of this run, which is
reproduced where it differs by no more than `within`. It is NODE.READOUT, or
NODE.PORT.mean (sigma, minimum, maximum) of a picture, or NODE.mtf_nyquist_x (ptf, y; `total` for
the product). `conflicts` is a list of texts: where the source contradicts itself.

The figures of a shipped network belong to its own modules, wires, values and scene. A changed
network that still carries them is not compared.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from app.run.evaluation import Evaluation
from app.run.shipped import shipped_networks
from core.chain.engine import Plan
from core.chain.realize import realize
from core.chain.wires import Image
from core.errors import NetworkError
from core.modules.parameters import plain
from core.names import close
from core.network.file import read_network
from core.network.network import Network
from core.network.validation import plain_network

REPRODUCED, DIFFERENT, ABSENT = "reproduced", "not reproduced", "not computed"
_STATISTICS: Mapping[str, Any] = {
    "mean": lambda samples: np.mean(samples, dtype=np.float64),
    "sigma": lambda samples: np.std(samples, dtype=np.float64),
    "minimum": np.min,
    "maximum": np.max,
}
_TEXTS = ("figure", "where", "unit", "from", "reason")
_FIELDS = (*_TEXTS, "value", "within")


def published_rows(evaluation: Evaluation, nyquist: Mapping[str, float]) -> list[dict[str, Any]]:
    """Each published figure with ours and a verdict; none for a shipped network that was changed.

    Raises
    ------
    NetworkError
        If the network's field is not as it should be.
    """
    entries = evaluation.network.extra.get("published", ())
    if not isinstance(entries, tuple):
        raise NetworkError("published must be a list of figures")
    if is_changed(evaluation):
        return []
    return [_row(evaluation, nyquist, number, entry) for number, entry in enumerate(entries, 1)]


def is_changed(evaluation: Evaluation) -> bool:
    """Whether the figures were published for a shipped network, and this one differs from it.

    The noise's seed, titles and the canvas make no difference.
    """
    wanted = _named(evaluation.network.extra.get("published", ()))
    changed = False
    for path in shipped_networks().values() if wanted else ():
        text = path.read_text(encoding="utf-8")
        if '"published":' in text and _named(json.loads(text).get("published", ())) == wanted:
            library = evaluation.engine.library
            network = plain_network(read_network(path, library=library), library=library)
            shipped = evaluation.engine.plan(network, folder=path.parent)
            if _content(shipped) == _content(evaluation.plan):
                return False
            changed = True
    return changed


def _named(entries: Any) -> list[Any]:
    """What is published, whatever the nodes are called."""
    rows = [entry for entry in entries if isinstance(entry, Mapping)]
    return [[entry.get(name) for name in ("figure", "where", "value")] for entry in rows]


def _content(plan: Plan) -> Any:
    """Modules with their values, and wires."""
    nodes = {
        name: (
            node.node.module,
            node.node.disabled,
            [plain(getattr(node.module, each.name)) for each in node.declaration.parameters],
        )
        for name, node in plan.nodes.items()
    }
    return nodes, set(plan.network.links)


def conflicts(network: Network) -> list[str]:
    """Where the source contradicts itself.

    Raises
    ------
    NetworkError
        If the network's field is no list of texts.
    """
    texts = network.extra.get("conflicts", ())
    if not isinstance(texts, tuple) or not all(isinstance(text, str) for text in texts):
        raise NetworkError("conflicts must be a list of texts")
    return list(texts)


def _row(
    evaluation: Evaluation, nyquist: Mapping[str, float], number: int, entry: Any
) -> dict[str, Any]:
    where = f"published figure {number}"
    if not isinstance(entry, Mapping) or "figure" not in entry or "value" not in entry:
        raise NetworkError(f"{where} must be an object with figure and value")
    for name, value in entry.items():
        if name not in _FIELDS:
            raise NetworkError(f"{where} has an unknown field {name!r:.80}{close(name, _FIELDS)}")
        if name in _TEXTS and not isinstance(value, str):
            raise NetworkError(f"{where}: {name} must be a text")
    row: dict[str, Any] = {name: entry.get(name, "") for name in _TEXTS}
    row |= {"value": entry["value"], "within": entry.get("within"), "ours": None}
    if not row["from"]:
        return row | {"verdict": ABSENT}
    if not _is_number(row["value"]) or not _is_number(row["within"]) or row["within"] < 0:
        raise NetworkError(f"{where} ({row['figure']}): value and within must be numbers")
    ours = _figure(evaluation, nyquist, row["from"], where)
    if not _is_number(ours):
        return row | {"verdict": ABSENT}
    # The limits are decimal: without the allowance, 0.003 ± 0.0005 would not hold 0.0035.
    limit = row["within"] + 1e-12 * abs(row["value"])
    verdict = REPRODUCED if abs(ours - row["value"]) <= limit else DIFFERENT
    return row | {"ours": ours, "verdict": verdict}


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float | np.number) and not isinstance(value, bool)


def _figure(evaluation: Evaluation, nyquist: Mapping[str, float], name: str, where: str) -> Any:
    parts = name.split(".")
    if name in nyquist:
        return nyquist[name]
    if len(parts) == 2 and parts[1] in evaluation.readouts.get(parts[0], {}):
        return evaluation.readouts[parts[0]][parts[1]]
    if len(parts) == 3 and parts[2] in _STATISTICS and parts[0] in evaluation.plan.nodes:
        image = evaluation.plan.nodes[parts[0]].outputs.get(parts[1])
        if isinstance(image, Image):
            return float(_STATISTICS[parts[2]](realize(image, evaluation.work)))
    known = [
        f"{node}.{readout}" for node, values in evaluation.readouts.items() for readout in values
    ]
    raise NetworkError(f"{where}: there is no figure {name!r:.80}{close(name, known)}")
