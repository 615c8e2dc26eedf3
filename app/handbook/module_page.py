"""What stands on a module's page, from its declaration."""

from __future__ import annotations

import html
import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from app.handbook.formula_drawing import FormulaError, formula_svg
from core.modules.declaration import Declaration, Port
from core.modules.parameters import Parameter, plain

_NONE: Mapping[str, str] = MappingProxyType({})
_MARKS = re.compile(r"\b(Sources?|Erratum|Errata): ")
_SYMBOL = re.compile(r"(?<![\w_])([^\W\d_]{1,3})_([^\W_]{1,5})(?![\w_])")


@dataclass(frozen=True)
class ShownFormula:
    """A formula, drawn, with its words as pieces of a page."""

    drawing: str
    where: str
    when: str


@dataclass(frozen=True)
class ModulePage:
    """The parts of the page, as pieces of it."""

    declared: Declaration
    paragraphs: tuple[str, ...]
    sources: tuple[str, ...]
    errata: tuple[str, ...]
    formulas: tuple[ShownFormula, ...]

    @property
    def words(self) -> str:
        """All that can be searched for."""
        declared = self.declared
        parts = [declared.key, declared.text]
        parts += [f"{p.name} {p.param.text}" for p in declared.parameters]
        parts += [f"{r.name} {r.meaning}" for r in declared.readouts]
        return " ".join(parts)


def module_page(declared: Declaration, addresses: Mapping[str, str] = _NONE) -> ModulePage:
    """What stands on the page.

    Parameters
    ----------
    declared : Declaration
        Of the module.
    addresses : mapping
        Where the pages of modules lie, from this one, by their titles.
    """
    others = {title: at for title, at in addresses.items() if title != declared.title}
    paragraphs, sources, errata = parted(declared.text)
    names = {parameter.name for parameter in declared.parameters}
    return ModulePage(
        declared,
        tuple(with_links(with_symbols(text, names), others) for text in paragraphs),
        tuple(prose(text, names) for text in sources),
        tuple(prose(text, names) for text in errata),
        tuple(
            ShownFormula(
                drawn(formula.tex),
                with_symbols(formula.where, names),
                prose(formula.when, names),
            )
            for formula in declared.formulas
        ),
    )


def drawn(tex: str) -> str:
    """A formula's drawing; its TeX as it is where a plug-in's cannot be typeset."""
    try:
        return formula_svg(tex)
    except FormulaError:
        return f"<code>{html.escape(tex)}</code>"


def parted(text: str) -> tuple[list[str], list[str], list[str]]:
    """Paragraphs of a module's text, its sources and its errata."""
    paragraphs: list[str] = []
    marked: dict[str, list[str]] = {"S": [], "E": []}
    for paragraph in text.split("\n\n"):
        words = " ".join(paragraph.split())
        pieces = _MARKS.split(words)
        if pieces[0].strip():
            paragraphs.append(pieces[0].strip())
        for mark, content in zip(pieces[1::2], pieces[2::2], strict=True):
            shown = (content[:1].upper() + content[1:]).strip()
            parts = shown.split("; ") if mark == "Sources" else [shown]
            marked[mark[0]] += [part.strip().rstrip(".") + "." for part in parts]
    return paragraphs, marked["S"], marked["E"]


def prose(text: str, names: Iterable[str]) -> str:
    """Plain text as a piece of a page; what stands in backticks, and names, as code."""
    shown = re.sub(r"`([^`]+)`", r"<code>\1</code>", html.escape(text, quote=False))
    words = sorted((name for name in names if "_" in name), key=len, reverse=True)
    if words:
        choice = "|".join(re.escape(word) for word in words)
        shown = re.sub(rf"(?<![\w>])({choice})(?![\w<])", r"<code>\1</code>", shown)
    return shown


def with_symbols(text: str, names: Iterable[str]) -> str:
    """Words below a formula: `x_k` is a symbol with an index."""
    pieces = re.split(r"(<code>.*?</code>)", prose(text, names))
    return "".join(
        piece if piece.startswith("<code>") else _SYMBOL.sub(r"\1<sub>\2</sub>", piece)
        for piece in pieces
    )


def with_links(piece: str, addresses: Mapping[str, str]) -> str:
    """A piece of a page in which titles of modules, of two words or more, lead to their pages."""
    titles = {
        html.escape(title, quote=False): at for title, at in addresses.items() if " " in title
    }
    if not titles:
        return piece
    names = "|".join(re.escape(title) for title in sorted(titles, key=len, reverse=True))
    parts = re.split(r"(<code>.*?</code>)", piece)
    return "".join(
        part
        if part.startswith("<code>")
        else re.sub(rf"\b({names})\b", lambda m: f'<a href="{titles[m[1]]}">{m[1]}</a>', part)
        for part in parts
    )


def ports(declared: tuple[Port, ...]) -> str:
    """Ports in words."""
    return ", ".join(
        f"{port.name} ({' or '.join(port.types)}{'' if port.required else ', optional'})"
        for port in declared
    )


def default(parameter: Parameter) -> str:
    """The default in words."""
    if parameter.required:
        return "required"
    value = plain(parameter.default)
    if value is None:
        return "empty"
    if isinstance(value, float):
        return f"{value:g}"
    return value or "empty" if isinstance(value, str) else json.dumps(value)
