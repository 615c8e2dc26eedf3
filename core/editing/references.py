"""Where a network's other fields mention its nodes: output, figures, dots of wires, ports."""

from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Any

from core.errors import NetworkError, thaw
from core.network.macro import FIELDS, Interface, interface_of, unfolded
from core.network.network import Link, Network, Node

WIRE_DOTS = "wire_dots"  # points that wires are bent through


def of_nodes(names: Iterable[str], nodes: Mapping[str, Node]) -> set[str]:
    """These nodes and, as ``MACRO/NODE``, those inside of the macros among them."""
    chosen = {name: nodes[name] for name in names if name in nodes}
    return {*names, *unfolded(Network(nodes=chosen)).nodes}


def renamed(extra: Mapping[str, Any], names: Mapping[str, str]) -> dict[str, Any]:
    """The fields with nodes' new names, by the old ones."""
    fields = dict(extra)
    if _of(fields.get("final")) in names:
        fields["final"] = _moved(fields["final"], names)
    if any(_of(row.get("from")) in names for row in _rows(fields)):
        fields["published"] = [
            {**row, "from": _moved(row["from"], names)} if _of(row.get("from")) in names else row
            for row in thaw(fields["published"])
        ]
    links = _links_of_dots(fields)
    if any(names.keys() & {link.source, link.target} for link in links if link is not None):
        fields[WIRE_DOTS] = [
            entry if link is None else {**entry, "link": link.renamed(names).text()}
            for entry, link in zip(thaw(fields[WIRE_DOTS]), links, strict=True)
        ]
    return _with_face_of(extra, fields, lambda face: face.renamed(names))


def dropped(extra: Mapping[str, Any], gone: set[str]) -> dict[str, Any]:
    """The fields without entries that name these nodes."""
    fields = dict(extra)
    if _of(fields.get("final")) in gone:
        del fields["final"]
    if any(_of(row.get("from")) in gone for row in _rows(fields)):
        rows = thaw(fields["published"])
        fields["published"] = [row for row in rows if _of(row.get("from")) not in gone]
    links = (link for link in _links_of_dots(fields) if link is not None)
    fields = without_dots(fields, {link for link in links if {link.source, link.target} & gone})
    return _with_face_of(extra, fields, lambda face: face.without(gone))


def without_dots(extra: Mapping[str, Any], gone: Collection[Link]) -> dict[str, Any]:
    """The fields without the dots of these wires."""
    fields, links = dict(extra), _links_of_dots(extra)
    if any(link in gone for link in links if link is not None):
        entries = zip(thaw(fields[WIRE_DOTS]), links, strict=True)
        fields[WIRE_DOTS] = [entry for entry, link in entries if link is None or link not in gone]
        if not fields[WIRE_DOTS]:
            del fields[WIRE_DOTS]
    return fields


def _with_face_of(
    extra: Mapping[str, Any], fields: dict[str, Any], change: Callable[[Interface], Interface]
) -> dict[str, Any]:
    if not any(isinstance(extra.get(name), Mapping) for name in FIELDS):
        return fields
    try:
        face = interface_of(extra)
    except NetworkError:  # of another form: left as it is
        return fields
    new = change(face)
    if new == face:
        return fields
    return {name: value for name, value in fields.items() if name not in FIELDS} | new.fields()


def dots_entry_link(entry: Any) -> Link | None:
    """The wire that an entry of the field of dots names; None where it names none."""
    ends = entry.get("link") if isinstance(entry, Mapping) else None
    if not isinstance(ends, tuple | list) or len(ends) != 2:
        return None
    try:
        return Link.between(*ends)
    except (NetworkError, AttributeError):  # no port, or no text
        return None


def _links_of_dots(fields: Mapping[str, Any]) -> list[Link | None]:
    entries = fields.get(WIRE_DOTS)
    if not isinstance(entries, tuple | list):
        return []  # of another form: left as it is
    return [dots_entry_link(entry) for entry in entries]


def _rows(fields: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    rows = fields.get("published")
    if not isinstance(rows, tuple | list) or not all(isinstance(row, Mapping) for row in rows):
        return []  # of another form: left as it is
    return list(rows)


def _of(port: Any) -> str | None:
    return port.rpartition(".")[0] if isinstance(port, str) else None


def _moved(port: str, names: Mapping[str, str]) -> str:
    node, _, name = port.rpartition(".")
    return f"{names[node]}.{name}"
