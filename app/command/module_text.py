"""A module of the library in text, and as facts for programs."""

from __future__ import annotations

import json
from textwrap import indent
from typing import Any

from app.run.readout_tables import columns
from core.modules.declaration import Declaration, package_of, ports_text
from core.modules.parameters import Parameter, plain


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
    ways = [ports_text(declared.inputs), ports_text(declared.outputs)]
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


def _default(parameter: Parameter) -> str:
    if parameter.required:
        return "(required)"
    value = plain(parameter.default)
    if value is None:
        return "empty"
    return json.dumps(value, ensure_ascii=False) if not isinstance(value, str) else value or '""'
