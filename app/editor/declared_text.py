"""What declarations and numbers are as text; and numbers as a person types them."""

import html
import re
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

from core.errors import ImagechainError, ParameterError, listed
from core.modules.parameters import Parameter
from core.network.expressions import ExpressionError, parse_expression, value_of

# Ends of names that are the unit, which stands beside the value.
_UNITS = re.compile(
    r"_(um|mm|cm|m|km|s|K|mK|Hz|W|deg|mrad|waves|dB|px|percent|per_km|m_per_s|mrad_per_s|cyc_per_mrad"
    r"|e|e_per_s|e_per_K|e_per_dn|dn|photons_per_cm2|A_per_W|A_per_cm2|per_um|lux|photons)$"
)
_ACRONYMS = """
    fov ifov gsd mtf mtf10 mtf50 ptf snr nep ner netd rer nei tdi psd prnu dsnu emva dn rms
    fwhm rmse psnr mrtd mdtd ttp flir92
"""
_WORDS: Mapping[str, str] = MappingProxyType(
    {
        **{word: word.upper() for word in _ACRONYMS.split()},
        "giqe5": "GIQE 5",
        "giqe4": "GIQE 4",
        "giqe3": "GIQE 3",
        "cn2": "Cn²",
        "r0": "r₀",
        "xi": "ξ",
        "eta": "η",
        "nyquist": "Nyquist",
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
        "r0_wavelength_um": "r₀ wavelength",
        "b_per_sr": "b",
        "l_mrad": "l",
        "s": "s",
        **{
            name: name[0] + "₁₂₃₄"[int(name[1]) - 1]
            for name in ("k1", "k2", "k3", "k4", "p1", "p2")
        },
        "air_K": "Air temperature",
        "responsivity_um": "Responsivity at",
        "beyond_percent": "Beyond the scene",
        "delta_K": "Temperature difference",
        "optics_K": "Optics' temperature",
        "housing_K": "Housing's temperature",
        "source_K": "Source's temperature",
        "reference_K": "Reference background",
        "reference_f_number": "Reference F number",
        "bad_pixel_percent": "Bad pixels",
        "dark_current_A_per_cm2": "Dark current density",
        "gain_dB": "Gain setting",
        "quantum_efficiency_percent": "QE in per cent",
        "cut_on_um": "Cut-on",
        "cut_off_um": "Cut-off",
        "use_mtf": "Use pre-amplifier MTF",
        "percent": "Share of local mean",
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


def flowing(text: str) -> str:
    """Paragraphs without the line breaks they have in the source."""
    return "\n\n".join(" ".join(part.split()) for part in text.split("\n\n"))


# Errors in the words of the window: the node's name and the panel's label, not the file's keys.


def error_text(error: ImagechainError, *, on_node: bool = False) -> str:
    """The error in one line: ``σ y of blur = -1 mrad is not allowed: …``."""
    text = error.message
    named = error.node is not None and not on_node
    if isinstance(error, ParameterError) and text.startswith(names := listed(error.parameters)):
        labels = listed([label_of(name) for name in error.parameters])
        return f"{labels}{f' of {error.node}' if named else ''}{text[len(names) :]}"
    return f"{error.node}: {text}" if named else text


DIGITS = 10  # significant ones, where that many are enough
FIGURE_DIGITS = 5  # of read-outs

_EXPONENT = re.compile(r"e\+?(-?)0*(?=\d)")
_WHOLE = re.compile(r"[+-]?\d{1,400}")
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")


def shown_number(value: float) -> str:
    """The shortest text of up to ten digits, or all it takes: reading it gives the same number."""
    if isinstance(value, int):
        return str(value)
    short = f"{value:.{DIGITS}g}"
    return _brief(short if float(short) == value else repr(value))


def shown_numbers(values: Sequence[float]) -> str:
    return ", ".join(shown_number(value) for value in values)


def shown_figure(value: object) -> str:
    """A read-out's value in five digits; a dash where there is none."""
    if value is None:
        return "—"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return str(value)
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return str(value)
    # One digit more where that is all of the number before the point.
    whole = 10**FIGURE_DIGITS <= abs(number) < 10 ** (FIGURE_DIGITS + 1)
    return _brief(f"{number:.{FIGURE_DIGITS + whole}g}")


def _brief(text: str) -> str:
    """``3e13`` instead of ``3e+13``."""
    return _EXPONENT.sub(r"e\1", text)


def number_of(text: str, parameter: Parameter) -> float | int | str | None:
    """The number a person typed; None for nothing, the text itself where it is no number.

    A comma is a decimal point. One that might set thousands apart, as in ``1,000``, is refused.
    """
    text = text.strip().replace("\N{MINUS SIGN}", "-")
    if not text:
        return None
    _refuse_thousands(_THOUSANDS.fullmatch(text), text, parameter)
    if _WHOLE.fullmatch(text):
        return int(text)
    if text.count(",") == 1 and "." not in text:
        text = text.replace(",", ".")
    try:
        return float(text) if "_" not in text else text
    except ValueError:
        return text


def _refuse_thousands(found: re.Match[str] | None, text: str, parameter: Parameter) -> None:
    if found is not None:
        whole, _, rest = found[0].partition(",")
        clear = f"write {whole}{rest} or {whole}.{rest}"
        raise ParameterError(parameter.name, text, clear, unit=parameter.param.unit)


def numbers_of(text: str, parameter: Parameter) -> list[float | int | str | None]:
    """The numbers of a list, between commas, spaces, or semicolons: then commas are decimal."""
    text = text.strip().strip("[]()").strip()
    if not text:
        return []
    if ";" in text:
        parts = text.split(";")
    elif "," in text:
        parts = text.split(",")
    else:
        parts = text.split()
    return [number_of(part, parameter) for part in parts]


_ANY_THOUSANDS = re.compile(r"(?<![\d.,])[1-9]\d{0,2},\d{3}(?![\d,.])")
_DECIMAL_COMMA = re.compile(r"(?<=\d),(?=\d)")
_ARITHMETIC = re.compile(r"[\d(]|\w\.\w")


def typed_number(text: str, parameter: Parameter) -> float | int | str | None:
    """The number a person typed, in the parameter's unit; the text where it is none.

    ``600 urad`` typed for mrad is 0.6, ``2*0.3`` is 0.6 in any unit. A comma is a decimal point
    except between the arguments of a function. Arithmetic without a value is refused.
    """
    number = number_of(text, parameter)
    if not isinstance(number, str) or not _ARITHMETIC.search(number):
        return number
    written = text.strip()
    if "(" not in written:
        _refuse_thousands(_ANY_THOUSANDS.search(written), text, parameter)
        written = _DECIMAL_COMMA.sub(".", written)
    try:
        return value_of(parse_expression(written), unit=parameter.param.unit)
    except ExpressionError as error:
        raise ParameterError(parameter.name, text, error.message, clause=True) from None
