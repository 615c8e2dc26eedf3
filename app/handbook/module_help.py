"""What a module does, for the window's help: text, typeset formulas, a table of its parameters."""

import html
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from app.handbook.written_pages import default, module_page
from core.modules.declaration import Declaration

_SVG = re.compile(r'<svg [^>]*aria-label="([^"]*)" width="([\d.]+)em" height="([\d.]+)em".*?</svg>')
_FINE = 2  # dots of a drawing for one of the text: some screens have as many
_LINES = "border-collapse: collapse; border-color: #808080"
_HEADS = ("Parameter", "Unit", "Range", "Default", "Meaning")


@dataclass(frozen=True)
class HelpText:
    """A text of simple HTML, and the drawings it names: SVG by address."""

    text: str
    drawings: Mapping[str, bytes]


def module_help(
    declared: Declaration, *, label: Callable[[str], str], em: float, ink: str
) -> HelpText:
    """The help of a module."""
    page = module_page(declared)
    drawings: dict[str, bytes] = {}

    def placed(drawing: str) -> str:
        """A formula as a picture, which Qt's text can hold, in place of a drawing in the text."""
        found = _SVG.fullmatch(drawing)
        if found is None:  # a plug-in's formula that cannot be typeset
            return drawing
        tex, width, height = found[1], round(float(found[2]) * em), round(float(found[3]) * em)
        address = f"formula:{len(drawings)}"
        svg = drawing.replace("<svg ", f'<svg xmlns="http://www.w3.org/2000/svg" fill="{ink}" ', 1)
        svg = svg.replace(f'"{found[2]}em"', f'"{_FINE * width}"', 1)
        drawings[address] = svg.replace(f'"{found[3]}em"', f'"{_FINE * height}"', 1).encode()
        return f'<img src="{address}" alt="{tex}" width="{width}" height="{height}">'

    parts = [f"<p>{text}</p>" for text in page.paragraphs]
    if page.formulas:
        parts.append("<h3>Formulas</h3>")
    for drawing, where, when in page.formulas:
        parts += [f"<p>{when}</p>"] if when else []
        parts.append(f"<p>{placed(drawing)}</p>")
        parts += [f'<p class="where">{where}</p>'] if where else []
    if declared.parameters:
        parts += ["<h3>Parameters</h3>", _table(declared, label)]
    for title, lines in (("Sources", page.sources), ("Errata of the sources", page.errata)):
        if lines:
            parts.append(f"<h3>{title}</h3>" + "".join(f"<p>{line}</p>" for line in lines))
    return HelpText("\n".join(parts), drawings)


def _table(declared: Declaration, label: Callable[[str], str]) -> str:
    """Each parameter by its name on the panel and in files, with unit, range and default."""
    rows = []
    for one in declared.parameters:
        name = f"{html.escape(label(one.name))}<br><code>{html.escape(one.name)}</code>"
        meaning = one.param.text[:1].upper() + one.param.text[1:]
        cells = (one.param.unit, one.allowed(), default(one), meaning)
        rows.append(f"<td>{name}</td>" + "".join(f"<td>{html.escape(str(c))}</td>" for c in cells))
    heads = "".join(f"<th>{head}</th>" for head in _HEADS)
    body = "".join(f"<tr>{row}</tr>" for row in rows)
    return f'<table cellpadding="4" border="1" style="{_LINES}"><tr>{heads}</tr>{body}</table>'
