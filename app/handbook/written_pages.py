"""All files of the handbook, made from one source: Markdown, and the modules' declarations."""

import hashlib
import html
import json
import re
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache, partial
from itertools import groupby
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.handbook import example_figures as figures
from app.handbook.markdown_text import anchor_of, formula_svg, rendered
from app.report.html_page import templates
from app.run import option_values, overrides, shipped
from app.user_folders import FOLDERS
from core.chain.engine import Engine
from core.chain.wires import Curve, Pupil
from core.errors import FileError, UsageError
from core.evaluation.work import Policy
from core.modules.declaration import Declaration, Library, declaration, ports_text
from core.modules.parameters import Parameter, plain
from core.network.file import load_network

TEMPLATES = Path(__file__).with_name("templates")
MARK = "handbook.json"
"""A file that only a handbook's folder has."""
DRAWN = "drawn.js"
"""A file that a handbook's folder has once its figures are drawn."""
_LATER = "The figures are being drawn and will appear on this page."
SYNONYMS = {
    word: subject
    for subject, words in {
        "plug-in": "add-on plugin",
        "--frames": "animation movie video",
        "studies": "batch monte parametric sweep",
        "fit": "calibrate",
        "microlens angle": "cra",
        "solve": "goal optimise optimize",
        "speed": "gpu",
        "dual gain": "hdr",
        "cluster": "hpc slurm",
        "spectral": "hyperspectral multispectral",
        "licence": "license",
        "figures of merit": "nv-ipm nvipm nvtherm",
        "focal plane": "operability",
        "read-out window": "roi",
        "iso 12233": "sfr",
        "w/m²/sr": "w/cm2 w/cm² w/m2",
    }.items()
    for word in words.split()
}
"""Words a reader may search for, and those under which the handbook has the subject."""


def module_address(key: str) -> str:
    return f"{figures.MODULES}/{key}.html"


def page_titles() -> dict[str, str]:
    return {
        name: _source(name).split("\n", 1)[0].lstrip("# ").strip()
        for pages in figures.PARTS.values()
        for name in pages
    }


def find_page(word: str, library: Library) -> tuple[str | None, list[str]]:
    """Address of the page, or None; and the names by which pages can be named."""
    pages = [(name, f"{name}.html", text, _source(name)) for name, text in page_titles().items()]
    for key, module in library.items():
        declared = declaration(module)
        parameters = " ".join(f"{p.name} {p.param.text}" for p in declared.parameters)
        pages.append((key, module_address(key), declared.title, f"{declared.text} {parameters}"))
    names, wanted = [name for name, *_ in pages], word.casefold().strip()
    known = {name.casefold(): address for name, address, *_ in pages}
    known |= {title.casefold(): address for _, address, title, _ in pages}
    for spelt in (wanted, wanted.replace(" ", "_").replace("-", "_")):
        if spelt in known:
            return known[spelt], names

    def rank(page: tuple[str, str, str, str]) -> tuple[bool, bool, int]:
        title, text = page[2].casefold(), page[3].casefold()
        return not title.startswith(wanted), wanted not in title, -text.count(wanted)

    _, best, title, text = min(pages, key=rank)
    if wanted in SYNONYMS and wanted not in title.casefold():
        return find_page(SYNONYMS[wanted], library)
    has = wanted in title.casefold() or wanted in text.casefold()
    return (best if wanted and has else None), names


def handbook_files(
    library: Library, progress: Callable[[str], None] = lambda _: None, *, drawn: bool = True
) -> Iterator[tuple[str, str]]:
    """Every file of the handbook: its name from the handbook's folder, and its content."""
    declared = [declaration(module) for module in library.values()]
    groups = list(dict.fromkeys(entry.group for entry in declared))
    declared.sort(key=lambda entry: groups.index(entry.group))
    frame = _Frame(declared, drawn=drawn)
    found = []
    engine = Engine(library)
    camera = cache(partial(figures.published_camera, engine=engine))

    def figure(words: str) -> str:
        if not drawn:
            return f"<p>{_LATER}</p>"
        kind, *names = words.split()
        if kind in ("published", "overview"):
            return frame.piece(f"{kind}_cameras.html", cameras=[camera(name) for name in names])
        return page_figure(words, engine)

    for name, known in page_titles().items():
        progress(known)
        addresses = {entry.title: module_address(entry.key) for entry in declared}
        title, lead, body, words = rendered(_source(name), addresses, figure)
        body += reference(declared) if name == figures.REFERENCE else ""
        address = f"{name}.html"
        yield address, frame.page(address, "page_frame.html", title, body=body)
        found.append([address, title, _plain(lead), _plain(words)])
    for entry in declared:
        progress(entry.title)
        address = module_address(entry.key)
        later = None if drawn else {"reason": _LATER}
        names = [parameter.name for parameter in entry.parameters]
        about: dict[str, Any] = {
            "page": module_page(entry, {one.title: f"{one.key}.html" for one in declared}),
            "example": later or figures.example_of(entry, engine),
            "inputs": ports_text(entry.inputs),
            "outputs": ", ".join(port.name for port in entry.outputs),
            "group_anchor": anchor_of(entry.group),
            "parameters": [
                (p, prose(p.param.text, names), p.allowed(), default(p)) for p in entry.parameters
            ],
            "readouts": [(r, prose(r.meaning, names)) for r in entry.readouts],
            "warnings": [prose(meaning, names) for _, meaning, _ in entry.warnings],
        }
        yield address, frame.page(address, "module_page.html", entry.title, **about)
        said = [entry.key, entry.text, *(f"{p.name} {p.param.text}" for p in entry.parameters)]
        said += [f"{readout.name} {readout.meaning}" for readout in entry.readouts]
        found.append([address, entry.title, _plain(entry.summary), _plain(" ".join(said))])
    words, synonyms = (json.dumps(table, ensure_ascii=False) for table in (found, dict(SYNONYMS)))
    yield "words.js", f"const WORDS = {words};\nconst SYNONYMS = {synonyms};\n"
    for name in ("handbook.css", "search.js"):
        yield name, (TEMPLATES / name).read_text(encoding="utf-8")
    if drawn:
        yield DRAWN, '"The figures are drawn.";\n'


def reference(declared: list[Declaration]) -> str:
    parts = []
    for group, members in groupby(declared, key=lambda entry: entry.group):
        rows = "".join(
            f'<li><a href="{module_address(entry.key)}">{html.escape(entry.listed)}</a>'
            f"<small>{with_symbols(entry.summary, ())}</small></li>"
            for entry in members
        )
        parts.append(
            f'<h2 id="{anchor_of(group)}">{html.escape(group)}</h2>\n'
            f'<ul class="modules">{rows}</ul>\n'
        )
    return "".join(parts)


def readable_handbook(library: Library) -> Path:
    """The handbook's folder in the cache, at once: where no figures are drawn yet, without them."""
    folder = _cached(library)
    if not (folder / DRAWN).is_file():
        write_handbook(folder, library, drawn=False)
    return folder


def cached_handbook(library: Library, progress: Callable[[str], None] = lambda _: None) -> Path:
    """The handbook's folder in the cache; its pages are made if they are not those of today."""
    folder = _cached(library)
    if not (folder / DRAWN).is_file():
        write_handbook(folder, library, progress)
        for other in folder.parent.glob("handbook-*"):
            if other != folder:
                shutil.rmtree(other, ignore_errors=True)
    return folder


def _cached(library: Library) -> Path:
    cache = FOLDERS.user_cache_path
    try:
        cache.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"cannot make the folder {cache}: {error.strerror or error}") from error
    return cache / f"handbook-{content_mark(library)}"


def content_mark(library: Library) -> str:
    """A name that changes with whatever the pages are made of."""
    digest = hashlib.sha256()
    for folder in (figures.PAGES, TEMPLATES, figures.SHIPPED / "published"):
        for path in sorted(folder.iterdir()):
            if path.is_file():
                digest.update(path.name.encode() + b"\0" + path.read_bytes())
    for module in library.values():
        digest.update(repr(declaration(module)).encode())
    for path in sorted(figures.PAGES.parent.glob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def write_handbook(
    folder: Path,
    library: Library,
    progress: Callable[[str], None] = lambda _: None,
    *,
    drawn: bool = True,
) -> None:
    """Write all pages to a folder: new, empty, or one with a handbook, which is replaced."""
    target = folder.resolve()
    replaces = (folder / MARK).is_file()
    if folder.exists() and not replaces and not (folder.is_dir() and not any(folder.iterdir())):
        raise FileError(
            f"cannot write the handbook to {folder}: it contains other files; choose a new folder"
        )
    if not target.parent.is_dir():
        raise FileError(
            f"cannot write the handbook to {folder}: there is no folder {target.parent}"
        )
    names = []
    try:
        with tempfile.TemporaryDirectory(
            prefix=".handbook-", dir=target.parent, ignore_cleanup_errors=True
        ) as made:
            pages = Path(made) / "pages"
            for name, content in handbook_files(library, progress, drawn=drawn):
                file = pages / name
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(content, encoding="utf-8", newline="\n")
                names.append(name)
            facts = {"format": "imagechain-handbook", "version": 1, "files": names}
            (pages / MARK).write_text(json.dumps(facts, indent=1) + "\n", encoding="utf-8")
            if target.exists():
                target.rename(Path(made) / "before")
            pages.rename(target)
    except OSError as error:
        if not replaces and (folder / MARK).is_file():  # another process has just made it
            return
        raise FileError(
            f"cannot write the handbook to {folder}: {error.strerror or error}"
        ) from error


class _Frame:
    """What all pages have: contents, and the pages before and after."""

    def __init__(self, declared: list[Declaration], *, drawn: bool) -> None:
        self._environment = templates(TEMPLATES)
        self._awaited = "" if drawn else DRAWN
        titles = page_titles()
        parts = figures.PARTS.items()
        self._parts = [(part, [(f"{n}.html", titles[n]) for n in pages]) for part, pages in parts]
        for group, members in groupby(declared, key=lambda entry: entry.group):
            entries = [(module_address(entry.key), entry.listed) for entry in members]
            self._parts.append((f"Modules: {group}", entries))
        self._order = [entry for _, entries in self._parts for entry in entries]

    def piece(self, template: str, **values: Any) -> str:
        return str(self._environment.get_template(template).render(**values))

    def page(self, address: str, template: str, title: str, **values: Any) -> str:
        place = next(at for at, entry in enumerate(self._order) if entry[0] == address)
        beside = [None, *self._order, None][place : place + 3 : 2]
        values |= {"title": title, "address": address, "root": "../" * address.count("/")}
        values |= {"awaited": self._awaited, "parts": self._parts}
        return self.piece(template, before=beside[0], after=beside[1], **{"body": "", **values})


def _source(name: str) -> str:
    return (figures.PAGES / f"{name}.md").read_text(encoding="utf-8")


def _plain(text: str) -> str:
    return " ".join(text.replace("`", "").replace("*", "").replace("\\", "").split())


# Drawings that a page of Markdown names in a block of `figure`.
#
# network mwir_camera            a shipped network, to be run
# set scene.width=320            a change of it, as --set has it
# picture scene.image the scene  a picture of a port, with its caption
# curve slices.curve the MTFs    curves of a port
# edges pixels.image what is used the edges of a port's picture, as a measurement draws them
# mtf pixels.image its MTF        and their MTF
# shipped thumbnail_pupils.png   a picture that comes along, with its caption
#
# A block that begins with `published`, or `overview`, names cameras of `networks/published`.


def page_figure(words: str, engine: Engine) -> str:
    lines = [line.split(maxsplit=2) for line in words.splitlines() if line.strip()]
    named = [line[1] for line in lines if line[0] == "network"]
    given = [line[1] for line in lines if line[0] == "set"]
    settings = [option_values.assignment("set", text, "NODE.PARAM=VALUE") for text in given]
    shown = [line for line in lines if line[0] not in ("network", "set")]
    drawings = []
    if named:
        place = shipped.find_network(named[0])
        network = load_network(place.path, library=engine.library)
        network = overrides.with_settings(network, settings, library=engine.library)
        plan, work = engine.plan(network, folder=place.folder), engine.work(Policy())
    for kind, what, *caption in shown:
        text = caption[0] if caption else what
        if kind == "shipped":
            png = (figures.SHIPPED / "pictures" / what).read_bytes()
            drawings.append(figures.png_figure(png, text, kind))
        elif kind == "picture":
            samples = engine.value(plan, what, work)
            drawn = np.abs(samples) if isinstance(plan.output(what), Pupil) else samples
            drawings.append(figures.picture(drawn, text))
        elif kind in ("edges", "mtf"):
            samples = engine.value(plan, what, work)
            drawings.append(_measured(samples, kind, text))
        elif kind == "curve" and isinstance(plan.output(what), Curve):
            drawings.append(figures.curves(engine.value(plan, what, work), text))
        else:
            raise UsageError(f"unknown line in a handbook figure: {kind} {what}")
    return f'<div class="figures">\n{"".join(drawings)}\n</div>\n'


def _measured(samples: NDArray[Any], kind: str, caption: str) -> str:
    # Imported only where a page has one: all that measures.
    from app.measure import measurement_page, measuring, picture_measurement

    picture = np.asarray(samples, np.float64)
    measured = measuring.measure_pictures(
        [picture_measurement.PictureFile.of("picture", [picture])]
    )
    if kind == "edges":
        return figures.png_figure(measurement_page.edges_png(measured, 0), caption, kind)
    return figures.png_figure(measurement_page.mtf_png(measured), caption, kind)


# What stands on a module's page, from its declaration.

_NONE: Mapping[str, str] = MappingProxyType({})
_MARKS = re.compile(r"\b(Sources?|Erratum|Errata): ")
_SYMBOL = re.compile(r"(?<![\w_])([^\W\d_]{1,3})_([^\W_]{1,5})(?![\w_])")


def module_page(declared: Declaration, addresses: Mapping[str, str] = _NONE) -> dict[str, Any]:
    others = {title: at for title, at in addresses.items() if title != declared.title}
    paragraphs, sources, errata = parted(declared.text)
    names = {parameter.name for parameter in declared.parameters}
    return {
        "declared": declared,
        "paragraphs": [with_links(with_symbols(text, names), others) for text in paragraphs],
        "sources": [prose(text, names) for text in sources],
        "errata": [prose(text, names) for text in errata],
        "formulas": [
            (drawn(formula.tex), with_symbols(formula.where, names), prose(formula.when, names))
            for formula in declared.formulas
        ],
    }


def drawn(tex: str) -> str:
    """A formula's drawing; its TeX as it is where a plug-in's cannot be typeset."""
    try:
        return formula_svg(tex)
    except ValueError:
        return f"<code>{html.escape(tex)}</code>"


def parted(text: str) -> tuple[list[str], list[str], list[str]]:
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
    return _outside_code(_SYMBOL, r"\1<sub>\2</sub>", prose(text, names))


def with_links(piece: str, addresses: Mapping[str, str]) -> str:
    """A piece of a page in which titles of modules, of two words or more, lead to their pages."""
    titles = {html.escape(t, quote=False): at for t, at in addresses.items() if " " in t}
    if not titles:
        return piece
    names = "|".join(re.escape(title) for title in sorted(titles, key=len, reverse=True))
    link = lambda found: f'<a href="{titles[found[1]]}">{found[1]}</a>'  # noqa: E731
    return _outside_code(re.compile(rf"\b({names})\b"), link, piece)


def _outside_code(pattern: re.Pattern[str], shown: Any, piece: str) -> str:
    parts = re.split(r"(<code>.*?</code>)", piece)
    return "".join(p if p.startswith("<code>") else pattern.sub(shown, p) for p in parts)


def default(parameter: Parameter) -> str:
    if parameter.required:
        return "required"
    value = plain(parameter.default)
    if value is None:
        return "empty"
    if isinstance(value, float):
        return f"{value:g}"
    return value or "empty" if isinstance(value, str) else json.dumps(value)
