"""What the README says one can run, and where it leads to; the rest stands in the handbook."""

import re
import tomllib

from app.handbook.example_figures import PAGES, PARTS
from child_process import ROOT
from command_line import read_words

TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", TEXT, re.MULTILINE | re.DOTALL)


def test_its_commands_are_those_there_are():
    inline = re.findall(r"`(?:\.venv/bin/)?imagechain ([^`]+)`", TEXT)
    blocks = re.findall(r"bin/imagechain (.+)$", "\n".join(b for _, b in BLOCKS), re.MULTILINE)
    commands = {read_words(*words.split()).info_name for words in (*inline, *blocks)}
    assert {"run", "edit", "handbook"} <= commands


def test_its_python_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    programs = [text for kind, text in BLOCKS if kind == "python"]
    assert programs
    for text in programs:
        exec(compile(text, "README.md", "exec"), {})
    assert (tmp_path / "mine.json").is_file()


def test_its_links_lead_somewhere():
    linked = re.findall(r"\]\((?!https:)([^)#]+)\)", TEXT)
    assert linked
    assert all((ROOT / target).exists() for target in linked)


def test_it_leads_to_every_page_of_the_handbook_but_the_lists():
    pages = {name for names in PARTS.values() for name in names} - {"index", "reference"}
    assert {name for name in pages if f"{PAGES.name}/{name}.md)" in TEXT} == pages


def test_extras_that_are_named_exist():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert set(re.findall(r"install [^'`]*'\.\[(\w+)\]'", TEXT)) <= {
        *project["optional-dependencies"]
    }
