"""Random networks, and random operations on them as a person with an editor would do them."""

from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

from core.editing import backdrops
from core.editing.clipboard import copied, duplicated, pasted
from core.editing.document import rebased
from core.editing.layout import arranged, made_way
from core.editing.operations import (
    ABSENT,
    Operation,
    add_nodes,
    keeping_values,
    mark_output,
    move_nodes,
    remove_nodes,
    rename_node,
    restored,
    rewire,
    set_network_field,
    set_node_field,
    set_parameter,
    together,
)
from core.editing.wiring import (
    continued,
    detached,
    dissolved,
    fitting,
    inserted,
    new_node,
    refusal,
    wired_to,
)
from core.modules.declaration import Library, declaration
from core.network.expressions import quoted
from core.network.file import format_network
from core.network.linked_values import expression, resolved
from core.network.network import Link, Network, Node

GONE = "module_of_another_version"
Maker = Callable[["Editor"], Operation | None]


class Editor:
    """Draws operations for a network."""

    def __init__(self, random: Random, network: Network, library: Library) -> None:
        self.random = random
        self.network = network
        self.library = library

    def name(self) -> str | None:
        names = list(self.network.nodes)
        return self.random.choice(names) if names else None

    def some(self) -> list[str]:
        names = list(self.network.nodes)
        return self.random.sample(names, min(len(names), self.random.randint(1, 4)))

    def point(self) -> tuple[float, float]:
        return float(self.random.randint(-900, 900)), self.random.uniform(-900, 900)

    def link(self) -> Link | None:
        """Between any two ports, whether it fits or not."""
        source, target = self.name(), self.name()
        if source is None or target is None:
            return None
        output, entry = self._port(source, "outputs"), self._port(target, "inputs")
        return Link(source, output, target, entry) if output and entry else None

    def fitting_link(self) -> Link | None:
        """One of twenty tries that fits."""
        for _ in range(20):
            link = self.link()
            if link is not None and refusal(self.network, self.library, link) is None:
                return link
        return None

    def _port(self, name: str, side: str) -> str:
        module = self.library.get(self.network.nodes[name].module)
        if module is None:
            return self.random.choice(["a", "b"])
        names = [port.name for port in getattr(declaration(module), side)]
        return self.random.choice(names) if names else ""


def drawn_network(random: Random, library: Library, most: int = 12) -> Network:
    """A network of modules and unknown ones, with all that a file can say of it."""
    keys = [*library, GONE, GONE]
    nodes = {}
    for number in range(random.randint(0, most)):
        key = random.choice(keys)
        name = random.choice([f"{key}_{number}", f"knoten {number}", f"ζ{number}"])
        params = {"strange": [1, {"a": 0.5}]} if key == GONE else {}
        auto, disabled = random.choice([None, None, True, False]), random.random() < 0.2
        extra = random.choice([{}, {}, {"pinned": True, "panel": {"open": [1, 2.5, None]}}])
        nodes[name] = Node(name, key, params, auto=auto, disabled=disabled, extra=extra)
    layout = {
        name: (random.randint(-500, 500), random.uniform(-500, 500))
        for name in nodes
        if random.random() < 0.7
    }
    network = Network("drawn", "of any kind", 7, nodes=nodes, layout=layout)
    editor = Editor(random, network, library)
    for _ in range(2 * len(nodes)):
        link = editor.fitting_link()
        if link is not None:
            editor.network = rewire(add=(link,)).apply(editor.network)
    extra = _extra(random, list(nodes))
    return Network(
        "drawn",
        "of any kind",
        7,
        nodes=nodes,
        links=editor.network.links,
        layout=layout,
        extra=extra,
    )


def _extra(random: Random, names: list[str]) -> dict[str, Any]:
    mentioned = [*names, "nobody", "jitter_mtf"]
    rows = [
        {"figure": f"f{number}", "from": f"{random.choice(mentioned)}.port", "value": number}
        for number in range(random.randint(0, 4))
    ]
    fields = {
        "final": f"{random.choice(mentioned)}.image",
        "published": rows,
        "conflicts": ["one says so", "the other does not"],
        "backdrops": [
            {"title": "Optics", "x": 1, "y": 2.5, "width": 300, "height": 200, "tint": "blue"},
            "what is this",
            {"title": "Detector", "x": -50, "y": 0, "width": 100.5, "height": 60},
        ],
        "of a later version": {"deep": [True, {"er": None}]},
    }
    return {name: value for name, value in fields.items() if random.random() < 0.7}


def _add(e: Editor) -> Operation | None:
    return new_node(e.network, e.library, e.random.choice(list(e.library)), e.point())[1]


def _add_unknown(e: Editor) -> Operation | None:
    node = Node(f"first {e.random.randint(0, 10**9)}", GONE, {"p": 1})
    taking = e.name()
    links = (Link(node.id, "a", taking, "a"),) if taking else ()
    unknown = taking is not None and e.network.nodes[taking].module == GONE
    return add_nodes(((node, None),), links if unknown else ())


def _remove(e: Editor) -> Operation | None:
    return remove_nodes(tuple(e.some())) if e.network.nodes else None


def _healed(e: Editor) -> Operation | None:
    how = e.random.choice((detached, dissolved))
    return how(e.network, e.library, e.some()) if e.network.nodes else None


def _continued(e: Editor) -> Operation | None:
    name, key = e.name(), e.random.choice(list(e.library))
    onward = continued(e.network, e.library, name, key, e.point()) if name else None
    return onward[1] if onward else None


def _made_way(e: Editor) -> Operation | None:
    names = [name for name in e.network.nodes if name in e.network.layout]
    if not names:
        return None
    name = e.random.choice(names)
    at = e.network.layout[name]
    places = made_way(e.network, {}, name, at, e.network.followers[name])
    return move_nodes(dict(places)) if places else None


def _move(e: Editor) -> Operation | None:
    return move_nodes({name: e.point() for name in e.some()})


def _rename(e: Editor) -> Operation | None:
    old = e.name()
    new = e.random.choice([f"named {e.random.randint(0, 99)}", "nobody", "jitter_mtf", "x", "ö ö"])
    return None if old is None or new in e.network.nodes else rename_node(old, new)


def _connect(e: Editor) -> Operation | None:
    link = e.fitting_link()
    return rewire(add=(link,)) if link else None


def _disconnect(e: Editor) -> Operation | None:
    links = e.network.links
    return rewire(remove=(e.random.choice(links),)) if links else None


def _redraw(e: Editor) -> Operation | None:
    link = e.fitting_link()
    links = [each for each in e.network.links if each != link]
    return rewire(add=(link,), remove=(e.random.choice(links),)) if link and links else None


def _wired(e: Editor) -> Operation | None:
    name = e.name()
    module = e.library.get(e.network.nodes[name].module) if name else None
    if name is None or module is None:
        return None
    known = declaration(module)
    ports = [(p, "output") for p in known.outputs] + [(p, "input") for p in known.inputs]
    port, side = e.random.choice(ports)
    found = fitting(e.library, port.types, "input" if side == "output" else "output")
    if not found:
        return None
    end = (name, port.name, side)
    return wired_to(e.network, e.library, end, e.random.choice(found), e.point())[1]


def _inserted(e: Editor) -> Operation | None:
    if not e.network.links:
        return None
    free = [name for name in e.network.nodes if not e.network.followers[name]]
    links = e.random.sample(e.network.links, min(8, len(e.network.links)))
    for link in links:
        for name in free:
            found = inserted(e.network, e.library, link, name)
            if found is not None:
                return together((move_nodes({name: e.point()}), found), found.text)
    return None


def _parameter(e: Editor) -> Operation | None:
    name = e.name()
    if name is None:
        return None
    module = e.library.get(e.network.nodes[name].module)
    names = [p.name for p in declaration(module).parameters] if module else ["strange", "new"]
    values = [0, 1, 1.0, True, 0.25, "auto", [1, 2.0], None, {"a": [1]}, Path("a/b.png"), ABSENT]
    return set_parameter(name, e.random.choice(names), e.random.choice(values)) if names else None


def _expression(e: Editor) -> Operation | None:
    """A parameter that follows another, which may be there or not."""
    name, other = e.name(), e.random.choice([e.name(), "nobody", "x"])
    if name is None or other is None:
        return None
    module = e.library.get(e.network.nodes[name].module)
    names = [p.name for p in declaration(module).parameters] if module else ["strange"]
    leaders = e.random.choice(["f_number", "width", "sigma_x_mrad", "strange"])
    texts = [f"{quoted(other)}.{leaders} * 2", f"'{other}'.{leaders}", "1 +", "2 um", ""]
    value = expression(e.random.choice(texts))
    return set_parameter(name, e.random.choice(names), value) if names else None


def _remove_leaders(e: Editor) -> Operation | None:
    if not e.network.nodes:
        return None
    names = e.some()
    taking = dissolved(e.network, e.library, names)
    value_of = resolved(e.network, library=e.library).value
    return keeping_values(network=e.network, names=names, taking=taking, value_of=value_of)[0]


def _switch(e: Editor) -> Operation | None:
    name = e.name()
    if name is None:
        return None
    field = e.random.choice(["auto", "disabled"])
    values = [True, False] if field == "disabled" else [True, False, None]
    return set_node_field(name, field, e.random.choice(values))


def _output(e: Editor) -> Operation | None:
    name = e.name()
    return mark_output((name,) if name and e.random.random() < 0.7 else ())


def _node_extra(e: Editor) -> Operation | None:
    name = e.name()
    value = e.random.choice([True, False, ABSENT, [1, {"b": 2}]])
    return set_node_field(name, e.random.choice(["pinned", "note"]), value) if name else None


def _network_field(e: Editor) -> Operation | None:
    pairs = [("name", "Øre"), ("description", ""), ("seed", e.random.randint(0, 9))]
    return set_network_field(*e.random.choice(pairs))


def _extra_field(e: Editor) -> Operation | None:
    value = e.random.choice([ABSENT, [1, 2], {"a": 1}, "jitter_mtf.image", None])
    return set_network_field(e.random.choice(["final", "published", "conflicts", "other"]), value)


def _backdrop(e: Editor) -> Operation | None:
    made = backdrops.Backdrop("Stage", *e.point(), e.random.uniform(1, 500), 40.0)
    count = len(backdrops.backdrops_of(e.network))
    kind = e.random.choice(["add", "around", "change", "remove"])
    if kind == "around" and e.network.layout:
        return backdrops.around(e.network, e.network.layout, {})
    if kind in ("change", "remove") and count:
        index = e.random.randrange(count)
        if kind == "remove":
            return backdrops.remove(e.network, index)
        return backdrops.change(e.network, index, made)
    return backdrops.add(e.network, made)


def _dots(e: Editor) -> Operation | None:
    if not e.network.links:
        return None
    link = e.random.choice(e.network.links)
    here = len(backdrops.dots_of(e.network).get(link, ()))
    kind = e.random.choice(["add", "add", "move", "remove", "straighten"])
    if kind == "straighten":
        return backdrops.straighten(e.network, e.random.sample(e.network.links, 1))
    if kind == "add" or not here:
        return backdrops.add_dot(e.network, link, e.random.randint(0, here), e.point())
    index = e.random.randrange(here)
    if kind == "move":
        return backdrops.move_dot(e.network, link, index, e.point())
    return backdrops.remove_dot(e.network, link, index)


def _paste(e: Editor) -> Operation | None:
    if not e.network.nodes or len(e.network.nodes) > 40:
        return None
    text = copied(e.network, e.some(), e.library)
    if e.random.random() < 0.3:
        text = format_network(e.network, library=e.library)
    at = e.random.choice([None, e.point()])
    return pasted(text, e.network, e.library, at)[1]


def _duplicate(e: Editor) -> Operation | None:
    if not e.network.nodes or len(e.network.nodes) > 40:
        return None
    return duplicated(e.network, e.some(), e.library)[1]


def _arrange(e: Editor) -> Operation | None:
    only = e.random.choice([None, e.some()])
    return move_nodes(
        arranged(e.network, dict.fromkeys(e.network.nodes, (150.0, 90.0)), only), "Lay out"
    )


def _picture(e: Editor) -> Operation | None:
    """A picture that is dropped on the canvas."""
    name, adding = new_node(e.network, e.library, "read_image", e.point())
    path = e.random.choice(["scene.exr", "../pictures/scene.exr", "/elsewhere/scene.exr"])
    return together((adding, set_parameter(name, "path", path)), "Read scene.exr")


def _rebase(e: Editor) -> Operation | None:
    folders = [Path("/nowhere/one"), Path("/nowhere/two/deeper"), Path("/nowhere")]
    return restored(rebased(e.network, e.library, *e.random.sample(folders, 2)), "Rebase")


def _several(e: Editor) -> Operation | None:
    steps: list[Operation] = []
    before = e.network
    for maker in e.random.sample(MAKERS[:-1], 3):
        step = maker(e)
        if step is not None:
            steps.append(step)
            e.network = step.apply(e.network)
    e.network = before
    return together(steps, "Several") if steps else None


MAKERS: tuple[Maker, ...] = (
    _add, _add_unknown, _remove, _healed, _continued, _made_way,
    _move, _rename, _connect, _disconnect, _redraw, _wired, _inserted,
    _parameter, _switch, _output, _node_extra, _network_field, _extra_field, _backdrop, _dots,
    _paste,
    _duplicate, _arrange, _picture, _rebase, _expression, _expression, _remove_leaders, _several,
)  # fmt: skip

# What a drag of the mouse or a slider does again and again.
DRAGS: tuple[Maker, ...] = (
    _move, _parameter, _expression, _backdrop, _dots, _several, _node_extra, _network_field,
)  # fmt: skip
