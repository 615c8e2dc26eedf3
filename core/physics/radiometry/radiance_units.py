"""Units of radiance, parsed in full: what one of them is worth in W/m²/sr or W/m²/sr/µm.

A unit is a product of powers: watts (with a prefix) or photons per second, per area, per
steradian, and for spectral radiance per wavelength or per wavenumber. Files word it in many ways:
``W/m²/sr/µm``, ``W m-2 sr-1 um-1``, ``uW/(cm^2 sr nm)``, ``Watts/cm2/sr/um``,
``mW/m^2/sr/cm^-1``, ``photons/s/cm^2/sr/um``. Whether ``/m2 sr`` divides by sr is read as
the one way that makes a radiance; where both ways do, it is refused.
"""

import re
from typing import Literal

from core.errors import DataError
from core.records import dataclass

Spectral = Literal["", "µm", "cm⁻¹"]
_Powers = tuple[tuple[str, int], ...]

UNDERSTOOD = (
    "W (with or without the prefix n, u, µ, m or k) or photons/s, per m², cm², mm² or km² and per "
    "sr; for spectral radiance also per µm, nm, mm, cm, m or cm⁻¹; for example W/m²/sr, "
    "uW/cm^2/sr/um or W m-2 sr-1 um-1"
)

_PREFIXES = {"": 1.0, "p": 1e-12, "n": 1e-9, "u": 1e-6, "µ": 1e-6, "m": 1e-3, "k": 1e3, "M": 1e6}
_LENGTHS_M = {
    **dict.fromkeys(("m", "meter", "meters", "metre", "metres"), 1.0),
    **dict.fromkeys(("cm", "centimeter", "centimeters", "centimetre", "centimetres"), 1e-2),
    **dict.fromkeys(("mm", "millimeter", "millimeters", "millimetre", "millimetres"), 1e-3),
    **dict.fromkeys(("um", "µm", "micron", "microns", "micrometer", "micrometers"), 1e-6),
    **dict.fromkeys(("micrometre", "micrometres"), 1e-6),
    **dict.fromkeys(("nm", "nanometer", "nanometers", "nanometre", "nanometres"), 1e-9),
    **dict.fromkeys(("å", "angstrom", "angstroms"), 1e-10),
    **dict.fromkeys(("km", "kilometer", "kilometers", "kilometre", "kilometres"), 1e3),
}
_WATTS = ("w", "watt", "watts")
_PREFIX_WORDS = {"nano": "n", "micro": "u", "milli": "m", "kilo": "k"}
_PHOTONS = ("photon", "photons", "ph", "phot")
_SECONDS = ("s", "sec", "second", "seconds")
_STERADIANS = ("sr", "ster", "steradian", "steradians")
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺", "0123456789-+")
# Names, exponents (^-2, **2, -2, 2), brackets and signs of multiplication and division.
_TOKEN = re.compile(
    r"\s*(?:(?P<name>[A-Za-zµåÅ]+)"
    r"|(?P<power>(?:\^|\*\*)?\s*(?:\{(?P<a>[-+]?\d+)\}|\((?P<b>[-+]?\d+)\)|(?P<c>[-+]?\d+)))"
    r"|(?P<sign>[/()\[\]*·.×⋅∙-]))"
)
_DEEPEST = 20  # brackets within brackets; a damaged header may hold thousands
_HEADING = re.compile(r"(?:spectral\s+|band\s+|in-band\s+)*radiance\b\s*[:,=]?\s*", re.IGNORECASE)


@dataclass(frozen=True)
class RadianceUnit:
    """What a unit of radiance is.

    `factor` turns its samples into `name`; `photons` per second may stand instead of watts.
    `spectral` is per µm of wavelength or per cm⁻¹ of wavenumber, empty for the radiance of a band;
    `per_um` is how many of its own units of wavelength a µm has: 1000 where it is per nm.
    """

    factor: float
    photons: bool = False
    spectral: Spectral = ""
    per_um: float = 1.0

    @property
    def name(self) -> str:
        """The unit after the factor, such as ``W/m²/sr/µm``."""
        head = "photons/s" if self.photons else "W"
        return f"{head}/m²/sr" + (f"/{self.spectral}" if self.spectral else "")

    @property
    def integrated(self) -> "RadianceUnit":
        """The unit without its own unit of wavelength, as for nm of nW/m²/sr/nm."""
        return RadianceUnit(_rounded(self.factor / self.per_um), self.photons)


def radiance_unit(text: str) -> RadianceUnit | None:
    """Parse a unit in full; None for what is no radiance: K, DN, counts, an empty text.

    Refused if the text speaks of steradians, or of watts or photons per area, but is no unit of
    radiance or one that is not understood (`DataError`).
    """
    body = _body(text)
    try:
        tokens = _tokens(body)
    except ValueError:
        tokens = None
    if not _speaks_of_radiance(re.findall(r"[A-Za-zµåÅ]+", body)):
        return None
    readings = set()
    for chained in (False, True):
        try:
            readings.add(_radiance(_powers(tokens, chained=chained), body) if tokens else None)
        except ValueError:
            continue
    readings.discard(None)
    if len(readings) != 1:
        why = "can be read in two ways" if readings else "is not understood"
        raise DataError(f"the unit {text!r:.80} {why}; allowed: {UNDERSTOOD}")
    return readings.pop()


def _body(text: str) -> str:
    """Both code points of micro as one, without the word radiance and the brackets around all."""
    body = text.replace("\N{GREEK SMALL LETTER MU}", "µ").translate(_SUPERSCRIPTS)
    body = body.replace("\N{MINUS SIGN}", "-").replace("\N{ANGSTROM SIGN}", "Å").strip()
    rest = _HEADING.sub("", body, count=1) if _HEADING.match(body) else body
    return rest if rest else body


def _speaks_of_radiance(names: list[str]) -> bool:
    """Whether there are steradians, or a power per some length: photons alone may be a count."""
    if any(name.lower() in _STERADIANS for name in names):
        return True
    power = any(name.lower() in _PHOTONS or _watts(name) is not None for name in names)
    return power and any(_length_m(name) is not None for name in names)


def _watts(name: str) -> float | None:
    """Watts that a word stands for; None where it is no power."""
    for ending in _WATTS:
        if name.lower().endswith(ending):
            prefix = name[: len(name) - len(ending)]
            prefix = _PREFIX_WORDS.get(prefix.lower(), prefix)
            if prefix in _PREFIXES:
                return _PREFIXES[prefix]
            if prefix in ("U", "N"):  # headers in capitals
                return _PREFIXES[prefix.lower()]
    return None


def _tokens(body: str) -> list[str | int]:
    """Names, signs and exponents; an exponent stands as an integer behind what it belongs to."""
    tokens: list[str | int] = []
    place = 0
    while place < len(body.rstrip()):
        match = _TOKEN.match(body, place)
        if match is None:
            raise ValueError(f"{body[place:]!r} is not a unit")
        place = match.end()
        if match["power"] is None:
            sign = (match["name"] or match["sign"]).replace("[", "(").replace("]", ")")
            tokens.append("*" if sign in ("·", ".", "×", "⋅", "∙", "-") else sign)
        elif tokens and (tokens[-1] == ")" or _is_name(tokens[-1])):
            tokens.append(int(match["a"] or match["b"] or match["c"]))
        elif match["power"].strip() == "1" and tokens[-1:] == ["("]:  # as in (1/cm)
            tokens.append("1")
        else:
            raise ValueError(f"the exponent {match['power']} does not follow a unit")
    return tokens


def _is_name(token: str | int) -> bool:
    return isinstance(token, str) and token not in ("/", "*", "(", ")")


def _powers(tokens: list[str | int], *, chained: bool) -> _Powers:
    """Names with their exponents; `chained`: a stroke divides by all up to the next one."""
    powers, place = _product(tokens, 0, chained)
    if place != len(tokens):
        raise ValueError("there is one bracket too many")
    return powers


def _product(
    tokens: list[str | int], place: int, chained: bool, depth: int = 0
) -> tuple[_Powers, int]:
    if depth > _DEEPEST:
        raise ValueError("too many brackets")
    powers: list[tuple[str, int]] = []
    sign, waiting = 1, True  # waiting for a unit: at the start and behind a sign
    while place < len(tokens) and tokens[place] != ")":
        token = tokens[place]
        if token in ("/", "*", "per"):
            if waiting:
                raise ValueError("two signs in a row")
            if token != "*":
                sign = -1
            elif not chained:
                sign = 1
            waiting, place = True, place + 1
            continue
        if token == "(":
            part, place = _product(tokens, place + 1, chained, depth + 1)
            if place == len(tokens):
                raise ValueError("a bracket is not closed")
        elif isinstance(token, int):
            raise ValueError("two exponents in a row")
        else:
            part = () if token == "1" else ((token, 1),)
        place += 1
        power = 1
        if place < len(tokens) and isinstance(tokens[place], int):
            power, place = int(tokens[place]), place + 1
        powers += [(name, sign * power * own) for name, own in part]
        if not chained:
            sign = 1
        waiting = False
    if waiting:
        raise ValueError("a unit is missing")
    return tuple(powers), place


def _radiance(powers: _Powers, body: str) -> RadianceUnit:
    """What the powers are worth; ValueError where they are no radiance."""
    factor, photons, seen = 1.0, False, {"power": 0, "s": 0, "sr": 0}
    lengths: list[tuple[float, int]] = []
    for name, power in powers:
        lower, watts = name.lower(), _watts(name)
        if lower in _PHOTONS:
            photons = True
            seen["power"] += power
        elif lower in _SECONDS:
            seen["s"] += power
        elif lower in _STERADIANS:
            seen["sr"] += power
        elif (length := _length_m(name)) is not None:
            lengths.append((length, power))
        elif watts is not None and power == 1:
            if watts == 1e6 and body == body.upper():
                raise ValueError("MW in capitals may be milliwatts or megawatts")
            factor *= watts
            seen["power"] += 1
        else:
            raise ValueError(f"{name} is not part of a unit of radiance")
    if seen != {"power": 1, "s": -1 if photons else 0, "sr": -1}:
        raise ValueError("not a unit of radiance")
    areas = [length for length, power in lengths if power == -2]
    others = [(length, power) for length, power in lengths if power != -2]
    if len(areas) != 1 or len(others) > 1:
        raise ValueError("not a unit of radiance")
    factor /= areas[0] ** 2
    if not others:
        return RadianceUnit(_rounded(factor), photons)
    ((length, power),) = others
    if power == -1 and length <= 1.0:
        per_um = _rounded(1e-6 / length)
        return RadianceUnit(_rounded(factor * per_um), photons, "µm", per_um)
    if power == 1 and length in (1.0, 1e-2):
        return RadianceUnit(_rounded(factor * length / 1e-2), photons, "cm⁻¹")
    raise ValueError("not a unit of radiance")


def _length_m(name: str) -> float | None:
    if name == "Mm":
        return None
    return _LENGTHS_M.get(name.lower())


def _rounded(factor: float) -> float:
    """The power of ten that it is; products of decimal fractions miss it by a rounding."""
    return float(f"{factor:.12g}")
