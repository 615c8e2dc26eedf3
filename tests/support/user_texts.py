"""Every text that a user reads, with its place: `python tests/support/user_texts.py [KIND …]`.

Kinds: message (errors, warnings, notes), help (of options and parameters), window, docstring
(of modules and of the public package), page (README, handbook, reports, networks).
"""

import ast
import json
import re
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
CODE = ("core", "nodes", "app", "imagechain")
# What only a program reads: style sheets, formats, patterns and the like.
_CODE_LIKE = re.compile(
    r"^<\w+ |^[\s\W\d]*$|[{};]\s*$|^[\w.]+\(|^https?:|\\[dws]|<\w+[^>]*/?>\s*$|^QW|^\w+:$"
)
_SENTENCE_END = re.compile(r"(?<=[.!?:])\s+(?=[A-Z`*\[(0-9])")
_RAISES = re.compile(r"Error$|^error$|Problem|Refus|warn|^note$|Notice|Fault|Warning")


class Text(NamedTuple):
    """A text a user reads: its place as file:line, its kind and the words."""

    place: str
    kind: str
    words: str


@cache
def user_texts() -> list[Text]:
    """All of them, in the order of their places."""
    found = [text for room in CODE for path in sorted((ROOT / room).rglob("*.py"))
             for text in _of_code(path)]  # fmt: skip
    pages = [ROOT / "README.md", *sorted((ROOT / "app/handbook/pages").rglob("*.md"))]
    found += [text for path in pages for text in _of_page(path)]
    found += [text for path in sorted((ROOT / "app").rglob("*.html")) for text in _of_page(path)]
    return found + [text for path in sorted((ROOT / "networks").rglob("*.json"))
                    for text in _of_network(path)]  # fmt: skip


def sentences(texts: list[Text]) -> list[Text]:
    """The same cut into sentences; formulas alone are left out."""
    return [
        text._replace(words=words)
        for text in texts
        for words in _SENTENCE_END.split(" ".join(text.words.split()))
        if len(re.findall(r"[A-Za-z]{2,}", words)) >= 4
    ]


def _of_code(path: Path) -> Iterator[Text]:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    parents = {child: node for node in ast.walk(tree) for child in ast.iter_child_nodes(node)}
    name = path.relative_to(ROOT).as_posix()
    public = name.startswith("imagechain/")
    for node in ast.walk(tree):
        if isinstance(node, (ast.Constant, ast.JoinedStr)):
            parent = parents.get(node)
            if isinstance(parent, (ast.JoinedStr, ast.FormattedValue)):
                continue
            words = _words(node)
            if isinstance(parent, ast.Expr):
                owner = parents.get(parent)
                if _is_docstring(parent, owner) and (public or _is_module(owner)):
                    yield Text(f"{name}:{node.lineno}", "docstring", words)
                elif _is_meaning(parent, owner):
                    yield Text(f"{name}:{node.lineno}", "help", words)
            elif _is_prose(words) and not _is_names(node, parent):
                yield Text(f"{name}:{node.lineno}", _kind(node, parents, name), words)


def _words(node: ast.Constant | ast.JoinedStr) -> str:
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else ""
    return "".join(
        part.value if isinstance(part, ast.Constant) else "{" + ast.unparse(part.value) + "}"
        for part in node.values
    )


def _is_docstring(node: ast.Expr, owner: ast.AST | None) -> bool:
    kinds = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    if not isinstance(owner, kinds) or owner.body[0] is not node:
        return False
    return isinstance(owner, ast.Module) or not owner.name.startswith("_")


def _is_module(owner: ast.AST | None) -> bool:
    if not isinstance(owner, ast.ClassDef):
        return False
    bases = [base.id for base in owner.bases if isinstance(base, ast.Name)]
    return any(word.arg == "key" for word in owner.keywords) or any(
        base == "Module" or base.endswith("Base") for base in bases
    )


def _is_meaning(node: ast.Expr, owner: ast.AST | None) -> bool:
    """The docstring of a read-out or a warning, which the module's page shows."""
    return (
        isinstance(owner, ast.FunctionDef)
        and owner.body[0] is node
        and any(re.match(r"(readout|warning)\b", ast.unparse(one)) for one in owner.decorator_list)
    )


def _is_names(node: ast.AST, parent: ast.AST | None) -> bool:
    """Names with blanks between: the parameters of a panel's section, what is taken apart."""
    if isinstance(parent, ast.Call):
        return getattr(parent.func, "id", "") == "Section" and parent.args[1:2] == [node]
    return isinstance(parent, ast.Attribute) and parent.attr == "split"


def _is_prose(words: str) -> bool:
    plain = re.sub(r"\{[^}]*\}", "", words)
    return len(re.findall(r"[a-z]{2,}", plain)) >= 2 and " " in plain.strip() and (
        not _CODE_LIKE.search(re.sub(r"\{[^{}]*\}", "…", words).strip()))  # fmt: skip


_OPTIONS = {
    "option",
    "argument",
    "flag",
    "save_option",
    "written_outputs",
    "rare",
    "scene",
    "number",
}


def _kind(node: ast.AST, parents: dict[ast.AST, ast.AST], name: str) -> str:
    above: ast.AST | None = node
    while above is not None and not isinstance(above, ast.stmt):
        above = parents.get(above)
        if isinstance(above, ast.Call):
            called = above.func
            word = called.attr if isinstance(called, ast.Attribute) else getattr(called, "id", "")
            if _RAISES.search(word):
                return "message"
            if word in {"Param", "param", "Readout", "Input", "Output", *_OPTIONS}:
                return "help"
    if isinstance(above, ast.Raise):
        return "message"
    return "window" if name.startswith("app/editor/") else (
        "message")  # fmt: skip


def _of_page(path: Path) -> Iterator[Text]:
    name = path.relative_to(ROOT).as_posix()
    fenced = False
    block: list[str] = []
    first = 1
    for number, line in enumerate([*path.read_text(encoding="utf-8").splitlines(), ""], start=1):
        fence = line.lstrip().startswith("```")
        if fence:
            fenced = not fenced
        if not line.strip() or fence or line.startswith(("|", "#", "- ", "* ")) or fenced:
            if block and re.search(r"[a-z]{2,} ", " ".join(block)):
                yield Text(f"{name}:{first}", "page", "\n".join(block))
            block = []
        if line.strip() and not fenced and not fence:
            first = first if block else number
            block.append(line)


def _of_network(path: Path) -> Iterator[Text]:
    document = json.loads(path.read_text(encoding="utf-8"))
    for key in ("title", "description"):
        if document.get(key):
            yield Text(f"{path.relative_to(ROOT).as_posix()}:{key}", "page", document[key])
    for node in document.get("nodes", ()):
        if isinstance(node, dict) and node.get("comment"):
            yield Text(f"{path.relative_to(ROOT).as_posix()}:comment", "page", node["comment"])


if __name__ == "__main__":
    for text in user_texts():
        if len(sys.argv) == 1 or text.kind in sys.argv[1:]:
            print(f"{text.place} [{text.kind}] {text.words}")
