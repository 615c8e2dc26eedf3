"""What each node shows of its state."""

from collections.abc import Collection, Iterable, Mapping, Sequence

from app.editor.declared_text import error_text
from app.editor.evaluation.queries import Badge, BadgeKind
from core.chain.engine import Plan, PlannedNode
from core.chain.skipped import Skip, is_neutral
from core.errors import Cancelled, ImagechainError, ParameterError, UnconnectedError
from core.modules.declaration import Library, declaration
from core.modules.parameters import Caution
from core.network.macro import SEPARATOR
from core.network.network import Network

DISABLED = "disabled: the node passes any input through"
STALE = (
    "not updated: the result is from before your last changes; choose Generate Image to update it"
)
IDENTITY = "skipped: the node has no effect with these settings"


def badges(
    plan: Plan,
    library: Library,
    *,
    stale: Collection[str] = (),
    met: Iterable[ImagechainError] = (),
    skipped: Mapping[str, str] | None = None,
    warned: Iterable[Caution] = (),
) -> dict[str, Badge]:
    """Badges by node; a node that only runs has none.

    An error stands on the node it belongs to alone; the nodes after it wait for that. `stale` names
    nodes held back that would give something else by now, `met` are errors met while computing,
    `skipped` is from `skip_texts`, `warned` are warnings for which samples were looked at.
    """
    by_node: dict[str, Badge] = {}
    warned = tuple(warned)
    badge: Badge | None
    for name, planned in plan.nodes.items():
        if planned.error is not None:
            badge = _of_error(plan.network, library, name, planned.error)
        else:
            texts = [
                warning.text for warning in (*planned.warnings, *warned) if warning.node == name
            ]
            badge = _of_state(planned, name in stale, (skipped or {}).get(name), "\n".join(texts))
        if badge is not None:
            by_node[name] = badge
    for error in met:
        node = error.node
        if node is not None and node in plan.nodes and not _fails(by_node.get(node)):
            by_node[node] = _faulty(error)
            for name in _after(plan.network, node):
                if not _fails(by_node.get(name)):
                    by_node[name] = Badge("incomplete", f"waiting for {node}")
    return by_node


_URGENT: tuple[BadgeKind, ...] = ("error", "incomplete", "running", "warning", "stale")


def with_macros(by_node: Mapping[str, Badge], network: Network) -> dict[str, Badge]:
    """The badges, and on each macro the gravest of the nodes inside, which `network` has too."""
    shown = dict(by_node)
    for name, node in network.nodes.items():
        if node.macro is None:
            continue
        if node.disabled:
            shown[name] = Badge("disabled", DISABLED)
            continue
        head = f"{name}{SEPARATOR}"
        inside = [(other, badge) for other, badge in by_node.items() if other.startswith(head)]
        for kind in _URGENT:
            texts = [f"{other}: {badge.text}" for other, badge in inside if badge.kind == kind]
            if texts:
                shown[name] = Badge(kind, "\n".join(texts))
                break
    return shown


def skip_texts(skips: Sequence[Skip]) -> dict[str, str]:
    """What is left out of the work of nodes that are left out, or nearly so."""
    by_node: dict[str, list[str]] = {}
    for skip in skips:
        if skip.kind == "below_budget":
            bound = (
                "" if skip.bound is None else f" (at most {skip.bound:.1g} of the picture's range)"
            )
            by_node.setdefault(skip.node, []).append(skip.text + bound)
    for skip in skips:
        if skip.kind == "region" and skip.node in by_node:
            by_node[skip.node].append(skip.text)
    return {name: "\n".join(texts) for name, texts in by_node.items()}


def _of_state(
    planned: PlannedNode, stale: bool, skipped: str | None, warning_text: str
) -> Badge | None:
    if stale:
        return Badge("stale", f"{STALE}\n{warning_text}" if warning_text else STALE)
    if warning_text:
        skipped = IDENTITY if is_neutral(planned) else skipped
        return Badge("warning", f"{warning_text}\n{skipped}" if skipped else warning_text)
    if planned.node.disabled:
        return Badge("disabled", DISABLED)
    if is_neutral(planned):
        return Badge("skipped", IDENTITY)
    return Badge("skipped", skipped) if skipped else None


def _of_error(network: Network, library: Library, name: str, error: ImagechainError) -> Badge:
    if error.node not in (None, name):
        return Badge("incomplete", f"waiting for {error.node}")
    if isinstance(error, UnconnectedError):
        return Badge("incomplete", f"not connected: {_unconnected(network, library, name)}")
    return _faulty(error)


def _faulty(error: ImagechainError) -> Badge:
    parameters = error.parameters if isinstance(error, ParameterError) else ()
    return Badge("error", error_text(error, on_node=True), parameters)


def _unconnected(network: Network, library: Library, name: str) -> str:
    linked = {link.input for link in network.links_into(name)}
    ports = declaration(library[network.nodes[name].module]).inputs
    missing = [port for port in ports if port.required and port.name not in linked]
    return ", ".join(f"{port.name} needs {_article(' or '.join(port.types))}" for port in missing)


def _article(noun: str) -> str:
    return f"an {noun}" if noun[:1] in "aeiou" else f"a {noun}"


def _fails(badge: Badge | None) -> bool:
    return badge is not None and badge.kind in ("error", "incomplete")


def _after(network: Network, node: str) -> set[str]:
    dependents: set[str] = set()
    waiting = [node]
    while waiting:
        for name in network.followers.get(waiting.pop(), ()):
            if name not in dependents:
                dependents.add(name)
                waiting.append(name)
    return dependents


# Failures of our own, as errors of one line.


class OwnFailure(ImagechainError):
    """The program has failed, not its input."""


def as_error(error: Exception, node: str | None = None) -> ImagechainError:
    if isinstance(error, ImagechainError) and not isinstance(error, Cancelled):
        return error
    if isinstance(error, MemoryError):
        text = "not enough memory: make the picture smaller, or close other pictures"
        return OwnFailure(text, node=node)
    reason = " ".join(str(error).split())[:200]
    return OwnFailure(f"internal error: {type(error).__name__}: {reason}", node=node)
