"""``imagechain presets``: cameras, lenses, detectors and light that come with the program."""

from __future__ import annotations

import textwrap

from app.command.results import show
from app.options.command_options import Options
from app.run.preset_files import Preset, shipped_presets
from core.errors import UsageError
from core.names import shown
from nodes.library import standard_library

_SOURCE = "Source: "
_USE = (
    "To use a preset: in the editor, drag it from the library; in Python, "
    "chain.add(ic.preset('NAME'))."
)


def carry_out(options: Options, _stop: object) -> None:
    word = (options.word or "").casefold()
    found = [preset for preset in shipped_presets(standard_library()) if _fits(preset, word)]
    if not found:
        raise UsageError(f"there is no preset with {shown(word)}; imagechain presets lists them")
    show(options, lambda: [_facts(preset) for preset in found], *map(_entry, found), _USE)


def _fits(preset: Preset, word: str) -> bool:
    texts = (preset.path.stem, preset.title, preset.text, *preset.modules)
    return any(word in text.casefold() for text in texts)


def _facts(preset: Preset) -> dict[str, str]:
    about, _, source = preset.text.partition(_SOURCE)
    module = "macro" if preset.is_macro else preset.modules[0]
    facts = {"preset": preset.path.stem, "name": preset.title, "module": module}
    return facts | {"about": about.strip(), "source": source or about}


def _entry(preset: Preset) -> str:
    text = textwrap.fill(preset.text, 96, initial_indent="  ", subsequent_indent="  ")
    return f"{preset.path.stem} · {preset.title} ({_facts(preset)['module']})\n{text}"
