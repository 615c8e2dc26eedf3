"""Random operations on macros, beside all others a person with an editor would do."""

from core.editing.macros import at_level, expose, group, hide, rename_exposed, ungroup
from core.editing.operations import ABSENT, Operation, set_parameter
from core.errors import ImagechainError
from core.modules.declaration import declaration
from core.network.linked_values import expression, resolved
from core.network.macro import SEPARATOR, face_of_macro, macros_in, unfolded
from core.network.network import Network
from edited_networks import DRAGS, MAKERS, Editor, Maker


def _level(e: Editor) -> tuple[tuple[str, ...], Network]:
    """The network, or the inside of any macro."""
    levels: list[tuple[tuple[str, ...], Network]] = [((), e.network)]
    levels += [(tuple(name.split(SEPARATOR)), node.macro) for name, node in macros_in(e.network)]
    return e.random.choice([level for level in levels if SEPARATOR not in "".join(level[0])])


def _group(e: Editor) -> Operation | None:
    path, level = _level(e)
    if not level.nodes:
        return None
    names = e.random.sample(list(level.nodes), e.random.randint(1, min(4, len(level.nodes))))
    where = "".join(f"{macro}{SEPARATOR}" for macro in path)
    try:
        return at_level(path, group(level, e.library, names, "camera", where)[1])
    except ImagechainError:  # a way leads out and back in
        return None


def _ungroup(e: Editor) -> Operation | None:
    path, level = _level(e)
    macros = [name for name, node in level.nodes.items() if node.macro and not node.disabled]
    where = "".join(f"{macro}{SEPARATOR}" for macro in path)
    return (
        at_level(path, ungroup(level, e.library, e.random.choice(macros), where)[1])
        if macros
        else None
    )


def _inner(e: Editor) -> str | None:
    names = [name for name in unfolded(e.network).nodes if name not in e.network.nodes]
    return e.random.choice(names) if names else None


def _expose(e: Editor) -> Operation | None:
    name = _inner(e)
    module = e.library.get(unfolded(e.network).nodes[name].module) if name else None
    if name is None or module is None:
        return None
    names = [parameter.name for parameter in declaration(module).parameters]
    try:
        return expose(e.network, name, e.random.choice(names)) if names else None
    except ImagechainError:  # shown already
        return None


def _shown(e: Editor) -> tuple[str, str] | None:
    shown = [
        (macro, name)
        for macro, node in macros_in(e.network)
        for name in face_of_macro(node.macro).parameters
    ]
    return e.random.choice(shown) if shown else None


def _hide(e: Editor) -> Operation | None:
    shown = _shown(e)
    try:
        value_of = resolved(e.network, library=e.library).value
        return hide(e.network, *shown, value_of) if shown else None
    except ImagechainError:  # another follows it
        return None


def _rename_exposed(e: Editor) -> Operation | None:
    shown = _shown(e)
    new = f"called{e.random.choice('_ ')}{e.random.randint(0, 20)}"
    return rename_exposed(e.network, *shown, new) if shown else None


def _set(e: Editor) -> Operation | None:
    """A value inside, or by the macro's own name of it."""
    shown, name = _shown(e), _inner(e)
    value = e.random.choice([0.5, 1, 2.0, ABSENT])
    if shown and e.random.random() < 0.6:
        return set_parameter(*shown, value)
    parameter = e.random.choice(["sigma_mrad", "strange"])
    return set_parameter(name, parameter, value) if name else None


def _follow(e: Editor) -> Operation | None:
    """An expression that names a macro's parameter, a node inside, or one that is not there."""
    shown, name = _shown(e), _inner(e)
    leaders = [f"'{one}'.f_number * 2" for one in (name, "camera", "strange") if one]
    if shown:
        leaders += [f"'{shown[0]}'.{shown[1]}"] * 2
        return set_parameter(*shown, expression(e.random.choice(leaders)))
    return None


def _work_inside(e: Editor) -> Operation | None:
    path, level = _level(e)
    if not path:
        return None
    inner = Editor(e.random, level, e.library)
    step = e.random.choice(MAKERS)(inner)
    return at_level(path, step) if step is not None else None


MACRO_MAKERS: tuple[Maker, ...] = (
    *MAKERS, _group, _group, _group, _ungroup, _expose, _expose, _hide, _rename_exposed, _set,
    _set, _follow, _work_inside, _work_inside, _work_inside,
)  # fmt: skip
MACRO_DRAGS: tuple[Maker, ...] = (*DRAGS, _set, _work_inside)
