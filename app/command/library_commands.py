"""``imagechain networks``, ``modules``, ``presets``, ``handbook`` and ``bench``."""

from __future__ import annotations

import contextlib
import json as json_module
import os
import sys
import textwrap
from functools import partial
from importlib import import_module
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.command import options
from app.run import option_values as values
from app.run.terminal import Stop, Stopped, columns, print_error, values_of
from core.errors import UsageError, alike, close, shown
from core.modules.declaration import Declaration, package_of, ports_text, where_absent
from core.modules.parameters import Parameter, plain

if TYPE_CHECKING:
    from app.bench.tables import Measured
    from app.run.preset_files import Preset

BENCH_PARTS = ("speed", "precision", "peers", "studies", "measure")
_SOURCE = "Source: "
_USE = (
    "To use a preset: in the editor, drag it from the library; in Python, "
    "chain.add(ic.preset('NAME'))."
)


@options.command()
@options.json_flag
def networks(_stop: Stop, json: bool) -> None:
    """List the example networks."""
    from app.run.shipped import published_networks, shipped_networks

    facts = [
        {"network": name, "name": document["name"], "description": document["description"]}
        for name, path in shipped_networks().items()
        for document in [json_module.loads(path.read_text(encoding="utf-8"))]
    ]
    entries = (f"{one['network']} · {one['name']}\n{_filled(one['description'])}" for one in facts)
    published = ", ".join(published_networks())
    cameras = f"published cameras (imagechain handbook published): {published}"
    options.show(json, lambda: facts, *entries, textwrap.fill(cameras, 96))


def _filled(text: str) -> str:
    return textwrap.fill(text, 96, initial_indent="  ", subsequent_indent="  ")


@options.command()
@options.argument(
    "key", "[KEY|WORD]",
    "list only this module, or modules with this word in their key, title or summary",
    required=False,
)  # fmt: skip
@options.json_flag
def modules(_stop: Stop, key: str, json: bool) -> None:
    """List the modules.

    Give the key of a module to print everything about it, or a word to print the summary of each
    module with this word in its key, title or summary (or else in a parameter's name). Without
    either, ports, parameters and read-outs of all modules are printed.
    """
    from app.library_index import declarations
    from nodes.library import missing_modules, standard_library

    library, word = standard_library(), key.casefold()
    declared = list(declarations(library).values())
    found = key != "" and key not in library
    if found:
        texts = {e.key: f"{e.key}\n{e.listed}\n{e.summary}".casefold() for e in declared}
        names = {e.key: "\n".join(p.name.casefold() for p in e.parameters) for e in declared}
        by_text = [entry for entry in declared if word in texts[entry.key]]
        declared = by_text or [entry for entry in declared if word in names[entry.key]]
    elif key:
        declared = [entry for entry in declared if entry.key == key]
    if not declared:
        absent = where_absent(key, library)
        hint = f": {absent}" if absent else alike(key, library)
        hint = hint or "; imagechain modules lists all modules"
        raise UsageError(f"there is no module {shown(key)}{hint}")
    if json:
        options.show(json, lambda: [_described(entry) for entry in declared])
        return
    groups = list(dict.fromkeys(entry.group for entry in declared))
    declared.sort(key=lambda entry: groups.index(entry.group))
    if found:
        print(columns([(entry.key, entry.listed, entry.summary) for entry in declared]))
        return
    for group, members in groupby(declared, key=lambda entry: entry.group):
        print(f"{group}\n{'=' * len(group)}\n")
        for entry in members:
            print(_module_text(entry, whole=bool(key)), end="\n\n")
    for line in missing_modules(library) if not key else ():
        print_error(f"warning: {line}")


def _described(declared: Declaration) -> dict[str, Any]:
    return {
        **values_of(declared, "key", "title", "group"),
        "package": package_of(declared.key),
        **values_of(declared, "version", "summary", "text"),
        "formulas": [values_of(one, "tex", "where", "when") for one in declared.formulas],
        "sink": declared.sink,
        "inputs": [values_of(port, "name", "types", "required") for port in declared.inputs],
        "outputs": [values_of(port, "name", "types") for port in declared.outputs],
        "parameters": [_parameter(parameter) for parameter in declared.parameters],
        "readouts": [values_of(one, "name", "unit", "meaning") for one in declared.readouts],
    }


def _parameter(parameter: Parameter) -> dict[str, Any]:
    param = parameter.param
    described: dict[str, Any] = {
        "name": parameter.name, "kind": parameter.kind, "unit": param.unit, "text": param.text,
        "required": parameter.required, "empty": parameter.empty,
        "default": None if parameter.required else plain(parameter.default),
    }  # fmt: skip
    if parameter.choices:
        described["choices"] = list(parameter.choices)
    if param.low is not None:
        described |= {"low": param.low, "low_exclusive": param.above}
    if param.high is not None:
        described |= {"high": param.high, "high_exclusive": param.below}
    return described


def _module_text(declared: Declaration, *, whole: bool = False) -> str:
    about = declared.text if whole else declared.summary
    lines = [f"{declared.key} · {declared.listed}", textwrap.indent(about, "  ")]
    ways = [ports_text(declared.inputs), ports_text(declared.outputs)]
    lines.append(f"  ports: {' → '.join(ways).strip()}")
    rows = [
        (f"    {each.name}", _default(each), each.param.unit, each.allowed(), each.param.text)
        for each in declared.parameters
    ]
    if rows:
        lines += ["  parameters:", columns(rows)]
    readouts = [(f"    {each.name}", each.unit, each.meaning) for each in declared.readouts]
    if readouts:
        lines += ["  read-outs:", columns(readouts)]
    return "\n".join(lines)


def _default(parameter: Parameter) -> str:
    if parameter.required:
        return "(required)"
    value = plain(parameter.default)
    if value is None:
        return "empty"
    if isinstance(value, str):
        return value or '""'
    return json_module.dumps(value, ensure_ascii=False)


@options.command()
@options.argument(
    "word", "[WORD]", "list only presets with this word in their name, description or module",
    required=False,
)  # fmt: skip
@options.json_flag
def presets(_stop: Stop, word: str, json: bool) -> None:
    """List the built-in cameras, lenses, detectors and light."""
    from app.run.preset_files import shipped_presets
    from nodes.library import standard_library

    def fits(preset: Preset) -> bool:
        texts = (preset.path.stem, preset.title, preset.text, *preset.modules)
        return any(word.casefold() in text.casefold() for text in texts)

    found = [preset for preset in shipped_presets(standard_library()) if fits(preset)]
    if not found:
        word = word.casefold()
        raise UsageError(
            f"no preset has {shown(word)} in its name, description or module; imagechain presets "
            "lists all presets"
        )
    entries = (
        f"{preset.path.stem} · {preset.title} ({_module(preset)})\n{_filled(preset.text)}"
        for preset in found
    )
    options.show(json, lambda: [_preset_facts(preset) for preset in found], *entries, _USE)


def _module(preset: Preset) -> str:
    return "macro" if preset.is_macro else preset.modules[0]


def _preset_facts(preset: Preset) -> dict[str, str]:
    about, _, source = preset.text.partition(_SOURCE)
    facts = {"preset": preset.path.stem, "name": preset.title, "module": _module(preset)}
    return facts | {"about": about.strip(), "source": source or about}


@options.command()
@options.argument("word", "[WORD]", "a module, a page, or a word on a page", required=False)
@options.option(
    "--html", "DIR",
    "write the pages to a new folder or over an older handbook, without opening them",
    values.file_path)  # fmt: skip
@options.flag("--path", "print the path of the page without opening it")
@options.json_flag
def handbook(stop: Stop, word: str, html: Path | None, path: bool, json: bool) -> None:
    """Open the handbook at any page."""
    from app.handbook import written_pages as pages
    from app.handbook.example_figures import PARTS
    from nodes.library import standard_library

    if html is not None and path:
        raise UsageError(
            "--html DIR and --path cannot be used together: --html already prints the path"
        )
    library = standard_library()
    address: str | None = "index.html"
    if word:
        address, known = pages.find_page(word, library)
        if address is None:
            hint = close(word, known) or "; run imagechain handbook to open the first page"
            raise UsageError(f"the handbook has no page on {shown(word)}{hint}")
    with options.Progress(sum(map(len, PARTS.values())) + len(library)) as progress:

        def made_next(title: str) -> None:
            if stop.is_set():
                raise Stopped
            progress(title)

        opened = html is None and not path
        if html is not None:
            pages.write_handbook(html, library, made_next)
            folder = html
        elif opened:
            folder = pages.readable_handbook(library)
        else:
            folder = pages.cached_handbook(library, made_next)
        page = folder.resolve() / str(address)
        options.show(json, lambda: {"page": str(page)}, str(page))
        if opened:
            _open_page(page)
            pages.cached_handbook(library, made_next)


def _open_page(page: Path) -> None:
    import webbrowser  # only where a page is opened

    displays = ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")
    if sys.platform in ("win32", "darwin") or any(os.environ.get(name) for name in displays):
        with contextlib.suppress(OSError, webbrowser.Error):
            webbrowser.open(page.as_uri())


@options.command()
@options.json_file("write all figures", values.file_path)
@options.option("--html", "FILE", "write a page with tables and plots", values.file_path)
@options.flag("--quick", "use fewer repetitions and sizes")
@options.option(
    "--only", "PART", f"measure only this part: {', '.join(BENCH_PARTS)}",
    options.one_of(*BENCH_PARTS), many=True)  # fmt: skip
@options.option(
    "--size", "N", "side length of the picture in samples (default: 1024)", values.whole_number
)
def bench(
    stop: Stop,
    json: Path | bool | None,
    html: Path | None,
    quick: bool,
    only: tuple[str, ...],
    size: int | None,
) -> None:
    """Measure run time against error. The unit is a bare Fourier round trip."""
    from app.bench.tables import PARTS, bench_page, measured
    from app.bench.timing import SIZE, Settings, isolate
    from app.run.terminal import json_text

    isolate()
    settings = Settings(SIZE if size is None else size, quick)
    files = [path for path in (json, html) if isinstance(path, Path)]
    names = [name for name in PARTS if name in (only or PARTS)]

    def made() -> tuple[dict[str, Any], Measured]:
        wanted = {name: import_module(f"app.bench.{name}").MEASURES for name in names}
        return measured(wanted, PARTS, settings, say=partial(options.say, json))

    def content(made: tuple[dict[str, Any], Measured], path: Path) -> str:
        return json_text(made[0], 1) if path == json else bench_page(*made)

    facts, _ = options.written(files, (), stop, made, content)
    end = f"{facts['seconds']:.0f} s" + "".join(f"; wrote {path}" for path in files)
    options.show(json, lambda: facts, end)
