"""The first header of a FITS file: what turns stored numbers into values, and the checksums.

Source: FITS Working Group of the IAU, Definition of the Flexible Image Transport System 4.0 (2018),
sections 4.1.2 (value indicator: an equal sign and a blank), 4.2 (values; D as the sign of an
exponent), 4.4.1 (SIMPLE, BITPIX, NAXIS), 4.4.2.5 (BSCALE, BZERO, BLANK) and appendix J (DATASUM,
CHECKSUM).
"""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import FileError
from core.records import dataclass
from nodes.files.stored_bytes import stored_bytes

_BLOCK, _CARD = 2880, 80
_MOST_BLOCKS = 20_000
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[EDed][-+]?\d+)?")
_TEXT = re.compile(r"'((?:[^']|'')*)'")

# Those that define what the samples are.
_MOST_AXES = 4
_AXES = tuple(f"NAXIS{number}" for number in range(1, _MOST_AXES + 1))
_NUMBERS = ("BITPIX", "NAXIS", *_AXES, "BSCALE", "BZERO", "BLANK")
_USED = (*_NUMBERS, "SIMPLE", "DATASUM")
_START, _EXTENSION = b"SIMPLE  =", b"XTENSION"
_BITPIX = ("8", "16", "32", "-32", "-64")


@dataclass(frozen=True)
class FitsHeader:
    """The first header of a file: values by keyword, as text, and how numbers are scaled.

    `length` are the bytes up to the samples, `zero` and `scale` BZERO and BSCALE, `blank` the
    stored integer that stands for none.
    """

    path: Path
    cards: dict[str, str]
    length: int
    zero: float
    scale: float
    blank: int | None

    def values(self, stored: NDArray[Any]) -> NDArray[Any]:
        plain = self.zero == 0.0 and self.scale == 1.0
        if plain and self.blank is None:
            return stored
        values = stored.astype(np.float64)
        if not plain:
            values *= self.scale
            values += self.zero
        if self.blank is not None:
            values[stored == self.blank] = np.nan
        return values


def read_fits_header(path: Path) -> FitsHeader:
    cards: dict[str, str] = {}
    with stored_bytes(path) as file:
        for start in range(0, _MOST_BLOCKS * _BLOCK, _BLOCK):
            content = file[start : start + _BLOCK]
            for place in range(0, len(content), _CARD):
                card = content[place : place + _CARD].decode("latin-1")
                if card.rstrip() == "END":
                    return _header(path, cards, start + _BLOCK)
                _add(cards, card, path)
            if len(content) < _BLOCK:
                break
    raise FileError(f"{path}: this FITS file is damaged or truncated: its header has no END")


def refuse_unsupported(path: Path) -> None:
    with stored_bytes(path) as file:
        if file[: len(_START)] != _START:
            return
        header = read_fits_header(path)
        extension = file[header.length : header.length + len(_EXTENSION)] == _EXTENSION
    simple = header.cards.get("SIMPLE", "")
    if simple != "T":
        # Which rule of the standard is not kept is written nowhere: any sample may mean another.
        raise FileError(
            f"{path}: SIMPLE = {simple:.40}, so the file does not follow the FITS standard and "
            "its samples cannot be interpreted; allowed: T"
        )
    if header.cards.get("NAXIS") == "0":
        where = "; only the extensions contain data" if extension else ""
        remedy = ": save the extension as a separate file" if extension else ""
        raise FileError(
            f"{path}: the primary header of this FITS file has no picture (NAXIS = 0){where}; "
            f"allowed: a picture in the primary header{remedy}"
        )
    bits = header.cards.get("BITPIX", "")
    if bits not in _BITPIX:
        raise FileError(f"{path}: BITPIX = {bits:.40}; allowed: {', '.join(_BITPIX)}")
    _check_axes(header)


def _check_axes(header: FitsHeader) -> None:
    """Refuse axes that span no planes; the library reads sizes up to a letter, and clamps them."""
    axes = _whole(header, "NAXIS", 1, _MOST_AXES)
    sizes = {key: _whole(header, key, 1) for key in _AXES[:axes]}
    if all(sizes.get(key, 1) > 1 for key in _AXES[2:]):
        shape = ", ".join(f"{key} = {size}" for key, size in sizes.items())
        raise FileError(
            f"{header.path}: {shape}: this file has two axes beyond rows and columns; allowed: "
            f"{' or '.join(_AXES[2:])} = 1, so that the other axis counts the bands"
        )


def _whole(header: FitsHeader, key: str, low: int, high: int | None = None) -> int:
    text = header.cards.get(key)
    if text is None:
        raise FileError(f"{header.path}: this FITS header is damaged: {key} is missing")
    if not re.fullmatch(r"\+?\d{1,20}", text) or int(text) < low or int(text) > (high or math.inf):
        span = f"of {low} or more" if high is None else f"from {low} to {high}"
        raise FileError(f"{header.path}: {key} = {text:.40}; allowed: a whole number {span}")
    return int(text)


def _header(path: Path, cards: dict[str, str], length: int) -> FitsHeader:
    zero, scale = _number(path, cards, "BZERO", 0.0), _number(path, cards, "BSCALE", 1.0)
    blank = cards.get("BLANK")
    if blank is None or cards.get("BITPIX", "").startswith("-"):
        return FitsHeader(path, cards, length, zero, scale, None)
    if not re.fullmatch(r"[-+]?\d{1,20}", blank):
        raise FileError(f"{path}: BLANK = {blank:.40}; allowed: a whole number")
    return FitsHeader(path, cards, length, zero, scale, int(blank))


def _number(path: Path, cards: dict[str, str], key: str, default: float) -> float:
    text = cards.get(key)
    if text is None:
        return default
    value = math.nan
    if _NUMBER.fullmatch(text):
        value = float(text.upper().replace("D", "E"))
    if not math.isfinite(value) or (key == "BSCALE" and value == 0.0):
        allowed = "a finite number" + (" other than 0" if key == "BSCALE" else "")
        raise FileError(f"{path}: {key} = {text:.40}; allowed: {allowed}")
    return value


def _add(cards: dict[str, str], card: str, path: Path) -> None:
    key = card[:8].rstrip()
    if card[8:10] != "= " or not key:
        if key in _USED:
            # By the standard it has no value; its writer meant one, and samples depend on it.
            raise FileError(
                f"{path}: {key} has no value: {card[8:].strip():.40} does not begin with an "
                "equals sign and a blank in columns 9 and 10"
            )
        return
    text = card[10:].strip()
    quoted = _TEXT.match(text)
    if quoted and key in _NUMBERS:
        raise FileError(f"{path}: {key} = {text:.40} is text; allowed: a number without quotes")
    value = quoted[1].replace("''", "'").rstrip() if quoted else text.partition("/")[0].strip()
    if cards.setdefault(key, value) != value and key in _USED:
        raise FileError(
            f"{path}: {key} is given twice, as {cards[key]:.40} and as {value:.40}; allowed: once"
        )


def check_sums(header: FitsHeader) -> None:
    """Refuse samples that DATASUM, or a file that CHECKSUM, was not made of."""
    stated = header.cards.get("DATASUM", "")
    whole = bool(header.cards.get("CHECKSUM"))
    if not stated and not whole:
        return
    sizes = [int(header.cards[key]) for key in _AXES[: int(header.cards["NAXIS"])]]
    size = abs(int(header.cards["BITPIX"])) // 8 * math.prod(sizes)
    size = -(-size // _BLOCK) * _BLOCK
    data = _ones_sum(header, header.length, size)
    if stated and (not re.fullmatch(r"\d{1,10}", stated) or int(stated) != data):
        raise FileError(
            f"{header.path}: this FITS file is damaged: its samples sum to {data}, "
            f"but DATASUM = {stated:.20}"
        )
    if whole and _folded(data + _ones_sum(header, 0, header.length)) not in (0, 0xFFFFFFFF):
        raise FileError(f"{header.path}: this FITS file is damaged: its CHECKSUM does not match")


def _ones_sum(header: FitsHeader, start: int, size: int) -> int:
    """Sum of words of 32 bits in ones' complement, what lacks at the end taken as zeros."""
    total = 0
    with stored_bytes(header.path) as file:
        for content in file.pieces(start, min(start + size, len(file))):
            words = np.frombuffer(content + bytes(-len(content) % 4), ">u4")
            total = _folded(total + int(words.sum(dtype=np.uint64)))
    return total


def _folded(total: int) -> int:
    while total >> 32:
        total = (total & 0xFFFFFFFF) + (total >> 32)
    return total
