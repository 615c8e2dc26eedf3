"""``imagechain modules``: the library, for people or for programs."""

from __future__ import annotations

import json
from itertools import groupby
from textwrap import indent
from typing import Any

from app.command.results import show
from app.library_index import declarations
from app.options.command_options import Options
from app.options.terminal_streams import print_error
from app.run.readout_tables import columns
from core.errors import UsageError
from core.modules.declaration import Declaration, Port, package_of, where_absent
from core.modules.parameters import Parameter, plain
from core.names import alike, shown
from nodes.library import standard_library
from nodes.plug_ins import missing_modules


def carry_out(options: Options, _stop: object) -> None:
    """Print every module, those that fit a word, or the one of that key.

    Of one module all its text is printed, of all of them ports, parameters and read-outs, of those
    that a word finds in key, title or summary the summary. A word in none of these is looked for in
    the parameters' names.
    """
    library, key = standard_library(), options.key
    declared = list(declarations(library).values())
    found = key != "" and key not in library
    if found:
        word = key.casefold()
        declared = [
            entry
            for entry in declared
            if any(word in text.casefold() for text in (entry.key, entry.listed, entry.summary))
        ]
        declared = declared or [
            entry
            for entry in declarations(library).values()
            if any(word in parameter.name.casefold() for parameter in entry.parameters)
        ]
    elif key:
        declared = [entry for entry in declared if entry.key == key]
    if not declared:
        absent = where_absent(key, library)
        hint = f": {absent}" if absent else alike(key, library)
        hint = hint or "; imagechain modules lists them"
        raise UsageError(f"there is no module {shown(key)}{hint}")
    if options.json is True:
        show(options, lambda: [described_module(entry) for entry in declared])
        return
    groups = list(dict.fromkeys(entry.group for entry in declared))
    declared.sort(key=lambda entry: groups.index(entry.group))
    if found:
        print(columns([(entry.key, entry.listed, entry.summary) for entry in declared]))
        return
    for group, members in groupby(declared, key=lambda entry: entry.group):
        print(f"{group}\n{'=' * len(group)}\n")
        for entry in members:
            print(module_text(entry, whole=bool(key)), end="\n\n")
    for line in missing_modules(library) if not key else ():
        print_error(f"warning: {line}")


def described_module(declared: Declaration) -> dict[str, Any]:
    return {
        "key": declared.key,
        "title": declared.title,
        "group": declared.group,
        "package": package_of(declared.key),
        "version": declared.version,
        "summary": declared.summary,
        "text": declared.text,
        "formulas": [
            {"tex": formula.tex, "where": formula.where, "when": formula.when}
            for formula in declared.formulas
        ],
        "sink": declared.sink,
        "inputs": [
            {"name": port.name, "types": list(port.types), "required": port.required}
            for port in declared.inputs
        ],
        "outputs": [{"name": port.name, "types": list(port.types)} for port in declared.outputs],
        "parameters": [_parameter(parameter) for parameter in declared.parameters],
        "readouts": [
            {"name": readout.name, "unit": readout.unit, "meaning": readout.meaning}
            for readout in declared.readouts
        ],
    }


def _parameter(parameter: Parameter) -> dict[str, Any]:
    param = parameter.param
    described: dict[str, Any] = {
        "name": parameter.name,
        "kind": parameter.kind,
        "unit": param.unit,
        "text": param.text,
        "required": parameter.required,
        "empty": parameter.empty,
        "default": None if parameter.required else plain(parameter.default),
    }
    if parameter.choices:
        described["choices"] = list(parameter.choices)
    if param.low is not None:
        described |= {"low": param.low, "low_exclusive": param.above}
    if param.high is not None:
        described |= {"high": param.high, "high_exclusive": param.below}
    return described


def module_text(declared: Declaration, *, whole: bool = False) -> str:
    about = declared.text if whole else declared.summary
    lines = [f"{declared.key} · {declared.listed}", indent(about, "  ")]
    ways = [_ports(declared.inputs), _ports(declared.outputs)]
    lines.append(f"  ports: {' → '.join(ways).strip()}")
    rows = [
        (
            f"    {parameter.name}",
            _default(parameter),
            parameter.param.unit,
            parameter.allowed(),
            parameter.param.text,
        )
        for parameter in declared.parameters
    ]
    if rows:
        lines += ["  parameters:", columns(rows)]
    readouts = [
        (f"    {readout.name}", readout.unit, readout.meaning) for readout in declared.readouts
    ]
    if readouts:
        lines += ["  read-outs:", columns(readouts)]
    return "\n".join(lines)


def _ports(ports: tuple[Port, ...]) -> str:
    return ", ".join(
        f"{port.name} ({' or '.join(port.types)}{'' if port.required else ', optional'})"
        for port in ports
    )


def _default(parameter: Parameter) -> str:
    if parameter.required:
        return "(required)"
    value = plain(parameter.default)
    if value is None:
        return "empty"
    return json.dumps(value, ensure_ascii=False) if not isinstance(value, str) else value or '""'
