"""Texts of a panel on parameters, read-outs and choices, made from their declarations."""

from __future__ import annotations

import html
import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from app.editor.number_text import shown_number, shown_numbers
from core.errors import ImagechainError, ParameterError
from core.modules.parameters import Parameter

# Ends of names that are the unit, which stands beside the value.
_UNITS = re.compile(
    r"_(um|mm|cm|m|km|s|K|mK|Hz|W|deg|mrad|waves|dB|px|percent|per_km|m_per_s|mrad_per_s|cyc_per_mrad"
    r"|e|e_per_s|e_per_K|e_per_dn|dn|photons_per_cm2)$"
)
_LONG_WORD, _PIECE = re.compile(r"\w{40,}"), re.compile(r"\w{1,16}")  # of names of files
_BREAK = "\u200b"  # of no width
_WORDS: Mapping[str, str] = MappingProxyType(
    {
        "fov": "FOV",
        "ifov": "IFOV",
        "gsd": "GSD",
        "mtf": "MTF",
        "mtf10": "MTF10",
        "mtf50": "MTF50",
        "ptf": "PTF",
        "snr": "SNR",
        "nep": "NEP",
        "ner": "NER",
        "netd": "NETD",
        "giqe5": "GIQE 5",
        "giqe4": "GIQE 4",
        "giqe3": "GIQE 3",
        "rer": "RER",
        "nei": "NEI",
        "tdi": "TDI",
        "psd": "PSD",
        "prnu": "PRNU",
        "dsnu": "DSNU",
        "dn": "DN",
        "rms": "RMS",
        "fwhm": "FWHM",
        "cn2": "Cn²",
        "r0": "r₀",
        "xi": "ξ",
        "eta": "η",
        "nyquist": "Nyquist",
        "rmse": "RMSE",
        "psnr": "PSNR",
        "mrtd": "MRTD",
        "mdtd": "MDTD",
        "ttp": "TTP",
        "flir92": "FLIR92",
        "ratches": "Ratches",
        "alpha": "α",
        "sigma": "σ",
        "fried": "Fried's",
        "tukey": "Tukey",
        "hamming": "Hamming",
        "lowpass": "low-pass",
        "highpass": "high-pass",
    }
)
_NAMES: Mapping[str, str] = MappingProxyType(
    {
        "d_star": "D*",
        "g_number": "G#",
        "f_number": "F number",
        "dtype": "Sample type",
        "xi": "Frequency ξ",
        "eta": "Frequency η",
        "r0_m": "r₀",
        "delta_K": "Temperature difference",
        "optics_K": "Optics' temperature",
        "housing_K": "Housing's temperature",
        "source_K": "Source's temperature",
        "reference_K": "Reference background",
        "reference_f_number": "Reference F number",
        "bad_pixel_percent": "Bad pixels",
        "cut_on_um": "Cut-on",
        "cut_off_um": "Cut-off",
        "use_mtf": "Use pre-amplifier MTF",
        "percent": "Share of the mean",
        "target_delta_K": "Target difference",
        "range_max_km": "Longest range",
        "display_cd_m2": "Display luminance",
        "display_deg": "Display size",
        "scan": "Axis",
    }
)


def label_of(name: str) -> str:
    """A name in words, without the unit at its end."""
    if name in _NAMES:
        return _NAMES[name]
    short = _UNITS.sub("", name)
    text = " ".join(_WORDS.get(word, word) for word in short.split("_"))
    return text[:1].upper() + text[1:] if text[:1].isascii() else text


def titled(name: str, module: str) -> str:
    """A node's name with its module's title, where that is more than the name again."""
    return f"{name} · {module}" if says_more(module, name) else name


def says_more(module: str, name: str) -> bool:
    """Whether a module's title is more than the node's name again: ``init_trans``, Init & Trans."""
    return _plain(module) != _plain(name)


def _plain(text: str) -> str:
    return "".join(letter for letter in text.casefold() if letter.isalnum())


def choice_text(choice: Any) -> str:
    if choice is None:
        return "empty"
    if not isinstance(choice, str):
        return str(choice)
    return " ".join(_WORDS.get(word, word) for word in choice.split("_"))


def placeholder_of(parameter: Parameter) -> str:
    _, marker, meant = parameter.param.text.partition("empty: ")
    return re.split(r"[;,.]", meant)[0].strip() if marker else "empty"


def shown_value(parameter: Parameter, value: Any) -> str:
    if value is None or value == "":
        return "empty"
    if parameter.kind in ("number", "integer"):
        return shown_number(value)
    if parameter.kind == "numbers":
        return shown_numbers(value) or "none"
    if parameter.kind == "switch":
        return "on" if value else "off"
    return choice_text(value) if parameter.kind == "choice" else str(value)


def about(parameter: Parameter) -> str:
    unit = f" {parameter.param.unit}" if parameter.param.unit else ""
    lines = [parameter.param.text[:1].upper() + parameter.param.text[1:]]
    if parameter.kind not in ("switch", "choice"):
        lines.append(f"Allowed: {parameter.allowed()}" + (f", in{unit}" if unit else ""))
    if not parameter.required:
        lines.append(f"Default: {shown_value(parameter, parameter.default)}{unit}")
    lines.append(f"In network files: {parameter.name}")
    return "\n".join(lines)


def tip(text: str) -> str:
    """Plain text as a tooltip, broken into lines where it is long."""
    return f"<p>{html.escape(text)}</p>".replace("\n", "<br>")


def breakable(text: str) -> str:
    """Text with places to break its lines at in words that are longer than any panel is wide."""
    return _LONG_WORD.sub(lambda word: _BREAK.join(_PIECE.findall(word[0])), text)


def flowing(text: str) -> str:
    """Paragraphs without the line breaks they have in the source."""
    return "\n\n".join(" ".join(part.split()) for part in text.split("\n\n"))


# Errors in the words of the window: the node's name and the panel's label, not the file's keys.


def error_text(error: ImagechainError, *, on_node: bool = False) -> str:
    """The error in one line: ``σ y of blur = -1 mrad is not allowed: …``."""
    text = error.message
    named = error.node is not None and not on_node
    if isinstance(error, ParameterError) and text.startswith(error.parameter):
        rest = text[len(error.parameter) :]
        return f"{label_of(error.parameter)}{f' of {error.node}' if named else ''}{rest}"
    return f"{error.node}: {text}" if named else text
