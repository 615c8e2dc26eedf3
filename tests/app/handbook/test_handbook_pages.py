"""The handbook's pages: whole, linked, with every module's formulas, from any folder."""

import json
import re
from html.parser import HTMLParser
from urllib.parse import unquote, urlsplit

import pytest

from app.handbook.example_figures import PAGES, PARTS
from app.handbook.markdown_text import rendered
from app.handbook.written_pages import (
    DRAWN,
    MARK,
    SYNONYMS,
    cached_handbook,
    content_mark,
    find_page,
    readable_handbook,
)
from command_line import run_here, run_process
from core.modules.declaration import declaration
from nodes.library import standard_library
from page_blocks import blocks_of

LIBRARY = standard_library()


class Links(HTMLParser):
    """What a page links to, and what in it can be linked to."""

    def __init__(self, text):
        super().__init__()
        self.targets, self.anchors, self.open, self.headings = [], [], [], 0
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.targets += [given[name] for name in ("href", "src") if given.get(name)]
        self.anchors += [given["id"]] if given.get("id") else []
        self.headings += tag == "h1"
        if tag not in ("meta", "link", "img", "input", "br", "path", "use", "line", "hr"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        if self.open and self.open[-1] == tag:
            self.open.pop()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The whole handbook, written once by the command."""
    place = tmp_path_factory.mktemp("written")
    done = run_here("handbook", "--html", "book", folder=place)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.strip() == str(place / "book" / "index.html")
    assert [path.name for path in place.iterdir()] == ["book"]
    return place / "book"


@pytest.fixture(scope="module")
def pages(folder):
    return {
        path.relative_to(folder).as_posix(): Links(path.read_text(encoding="utf-8"))
        for path in sorted(folder.rglob("*.html"))
    }


def test_the_written_handbook(folder, pages):
    # Every page and module has a page.
    listed = [name for names in PARTS.values() for name in names]
    assert {path.stem for path in PAGES.glob("*.md")} == set(listed)
    assert set(pages) == {
        *(f"{name}.html" for name in listed),
        *(f"modules/{key}.html" for key in LIBRARY),
    }
    facts = json.loads((folder / MARK).read_text(encoding="utf-8"))
    files = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    assert {*facts["files"], MARK} == files
    # Pages are whole.
    for name, page in pages.items():
        assert page.headings == 1, name
        assert not page.open, (name, page.open)
        twice = {anchor for anchor in page.anchors if page.anchors.count(anchor) > 1}
        assert not twice, name
        assert "`" not in re.sub(r"(?s)<pre>.*?</pre>", "", (folder / name).read_text("utf-8")), (
            name
        )
    # Links lead somewhere.
    for name, page in pages.items():
        here = folder / name
        for target in page.targets:
            parts = urlsplit(target)
            if parts.scheme == "data":
                continue
            if parts.scheme:
                assert parts.scheme == "https", (name, target)
                assert re.fullmatch(r"[\w.-]+\.\w+", parts.netloc), (name, target)
                continue
            file = (here.parent / unquote(parts.path)).resolve() if parts.path else here
            assert file.is_file(), (name, target)
            if parts.fragment and file.suffix == ".html":
                there = pages[file.relative_to(folder.resolve()).as_posix()].anchors
                assert unquote(parts.fragment) in there, (name, target)
    # Pages need nothing from outside.
    for path in folder.rglob("*.html"):
        text = path.read_text(encoding="utf-8")
        loaded = re.findall(r'<(?:script|link|img|iframe)\b[^>]*(?:src|href)="(https?:[^"]*)', text)
        assert not loaded, path
    assert "http" not in (folder / "handbook.css").read_text(encoding="utf-8")
    # The search knows every page.
    text = (folder / "words.js").read_text(encoding="utf-8")
    listed, others = re.fullmatch("const WORDS = (.*);\nconst SYNONYMS = (.*);\n", text).groups()
    assert json.loads(others) == SYNONYMS
    rows = json.loads(listed)
    assert {row[0] for row in rows} == set(pages)
    assert all(title and lead and words for _, title, lead, words in rows)
    # Every module is shown at work.
    for key in LIBRARY:
        text = (folder / "modules" / f"{key}.html").read_text(encoding="utf-8")
        example = text.partition('id="example"')[2].partition("<h2")[0]
        shown = "<figure" in example
        assert shown is (key not in {"write_image", "write_matrix", "noise_file"}), key
        assert "It was not run" not in example, key
        # It has formulas, each typeset, or states why not.
        declared = declaration(LIBRARY[key])
        assert bool(declared.formulas) != bool(declared.without_formula)
        drawings = re.findall(r'<svg class="formula".*?</svg>', text, re.DOTALL)
        assert len(drawings) >= len(declared.formulas), key
        assert "NaN" not in "".join(drawings), key


def test_the_command_opens_the_page_in_the_browser(tmp_path):
    """A browser of our own, as the user's is named by BROWSER."""
    folder = tmp_path / "imagechain" / f"handbook-{content_mark(LIBRARY)}"
    folder.mkdir(parents=True)
    for name in (MARK, DRAWN):
        (folder / name).write_text("{}")
    browser = tmp_path / "browser"
    browser.write_text(f'#!/bin/sh\necho "$1" > {tmp_path}/opened\n')
    browser.chmod(0o755)
    names = {"XDG_CACHE_HOME": str(tmp_path), "BROWSER": f"{browser} %s"}
    done = run_process("handbook", "gaussian_mtf", folder=tmp_path, env=names)
    page = folder / "modules" / "gaussian_mtf.html"
    assert (done.returncode, done.stdout, done.stderr) == (0, f"{page}\n", "")
    assert (tmp_path / "opened").read_text().strip() == page.as_uri()


def test_a_page_of_markdown():
    text = (
        "# A page\n\nWhat it is *about*.\n\n## One & two\n\n*Gaussian MTF* <b> [x](other.md#y)\n\n"
        "```math\nx^2\n```\n\n```json mine.json\n{}\n```\n\n| a |\n|---|\n| 1 |\n"
    )
    addresses = {"Gaussian MTF": "modules/gaussian_mtf.html"}
    title, lead, body, _ = rendered(text, addresses, lambda _: "")
    assert (title, lead) == ("A page", "What it is *about*.")
    assert '<h2 id="one-two">' in body
    assert '<a href="modules/gaussian_mtf.html">Gaussian MTF</a> &lt;b&gt;' in body
    assert '<a href="other.html#y">x</a>' in body
    assert '<svg class="formula"' in body
    assert '<div class="wide">\n<table>' in body
    assert [(b.kind, b.name, b.text) for b in blocks_of(text)][1] == ("json", "mine.json", "{}\n")


def test_a_word_finds_its_page():
    def found(word):
        return find_page(word, LIBRARY)[0]

    assert found("gaussian_mtf") == "modules/gaussian_mtf.html"
    assert found("Non-Uniformity Correction") == "modules/nuc.html"
    assert found("focal plane") == "modules/focal_plane.html"
    assert found("koschmieder") == "modules/atmospheric_path.html"
    assert found("sweep") == "studies.html"
    assert found("xyzzy") is None


def test_pages_are_made_once(tmp_path, monkeypatch):
    """And anew where a module has come or changed."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    made = []
    few = {key: LIBRARY[key] for key in ("gaussian_mtf", "jitter_mtf")}
    monkeypatch.setattr(
        "app.handbook.written_pages.handbook_files",
        lambda library, _, drawn: (
            made.append((len(library), drawn))
            or iter([("index.html", "x"), *([(DRAWN, "")] if drawn else ())])
        ),
    )
    assert not (readable_handbook(few) / DRAWN).exists()
    first = cached_handbook(few)
    assert cached_handbook(few) == first
    assert content_mark(few) == first.name.removeprefix("handbook-")
    assert readable_handbook(few) == first
    assert sorted(path.name for path in first.iterdir()) == [DRAWN, MARK, "index.html"]
    second = cached_handbook(LIBRARY)
    assert made == [(2, False), (2, True), (len(LIBRARY), True)]
    assert list(first.parent.iterdir()) == [second]


def test_what_cannot_be_written_is_one_line(tmp_path, monkeypatch):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.tex").write_text("all of it")
    done = run_here("handbook", "--html", "mine", folder=tmp_path)
    assert (done.returncode, done.stderr) == (
        2,
        "imagechain: cannot write the handbook to mine: it contains other files; "
        "choose a new folder\n",
    )
    done = run_here("handbook", "--html", "no/where", folder=tmp_path)
    assert done.returncode == 2
    assert "there is no folder" in done.stderr
    done = run_here("handbook", "gausian_mtf", "--path", folder=tmp_path)
    assert (done.returncode, done.stderr) == (
        2,
        "imagechain: the handbook has no page on gausian_mtf; did you mean gaussian_mtf?\n",
    )
    assert [path.name for path in tmp_path.rglob("*")] == ["mine", "thesis.tex"]
