"""Network files with random damage: edits of their JSON, bytes flipped, texts cut off."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Iterator
from random import Random
from typing import Any

Document = dict[str, Any]
Place = tuple[Any, Any]  # a list or an object, and an index or key of it
NUMBERS = (0, -1, 1, 0.5, -0.0, 1e308, -1e308, 5e-324, 2**63, 2**63 - 1, -(2**63), 10**40, 10**305)
TEXTS = (
    "", " ", "a", ".", "a.b", "..", "=", "\0", "\x1b[31m", "\n", "\u2028", "\u202e", "\ud800", "💥",
    "x" * 5000, "$\\frac{$", "<script>", "../../etc/passwd", "/dev/zero", "NaN", "é", "e\u0301",
)  # fmt: skip
RAW = (
    "NaN", "Infinity", "-Infinity", "1e999", "-1e999", "1" * 400, "1" * 5000, "0.1e-999", "01",
    "+1",
    "'a'", "[" * 70, "[" * 70 + "]" * 70, '{"a":' * 80 + "1" + "}" * 80, '"\\ud800"', '"\\u0000"',
    "true", "null", "// a", "{}", "[]", "\ufeff", '"unclosed',
)  # fmt: skip


def mutated(random: Random, document: Document) -> bytes:
    """The bytes of a file made of the document with one to four faults, or none that shows."""
    document = copy.deepcopy(document)
    for _ in range(random.choice((0, 1, 1, 1, 1, 2, 4))):
        random.choice(EDITS)(random, document)
    try:
        text = json.dumps(document, indent=random.choice((None, 1, 2)), ensure_ascii=False)
    except (ValueError, RecursionError):
        return b"{"
    if random.random() < 0.12:
        text = _raw_value(random, text)
    if random.random() < 0.06:
        text = _doubled_key(random, text)
    content = text.encode("utf-8", "surrogatepass")
    if random.random() < 0.12:
        content = _bytes_damaged(random, content)
    return content


def _places(value: Any) -> Iterator[Place]:
    rest = [value]
    while rest:
        holder = rest.pop()
        keys = list(holder) if isinstance(holder, dict) else list(range(len(holder)))
        for key in keys:
            yield holder, key
            if isinstance(holder[key], dict | list):
                rest.append(holder[key])


def _place(random: Random, document: Document) -> Place | None:
    places = list(_places(document))
    return random.choice(places) if places else None


def _strange(random: Random) -> Any:
    kind = random.randrange(6)
    if kind == 0:
        return random.choice(NUMBERS)
    if kind == 1:
        return random.choice(TEXTS)
    if kind == 2:
        return random.choice((None, True, False, [], {}, [[]], {"": None}))
    if kind == 3:
        return [random.choice(NUMBERS) for _ in range(random.randint(0, 5))]
    if kind == 4:
        deep: Any = 1
        for _ in range(random.choice((3, 30, 60, 64, 65, 200))):
            deep = [deep] if random.random() < 0.5 else {"a": deep}
        return deep
    return random.uniform(-1, 1) * 10 ** random.uniform(-30, 30)


def _replace(random: Random, document: Document) -> None:
    place = _place(random, document)
    if place:
        place[0][place[1]] = _strange(random)


def _delete(random: Random, document: Document) -> None:
    place = _place(random, document)
    if place:
        del place[0][place[1]]


def _swap(random: Random, document: Document) -> None:
    one, other = _place(random, document), _place(random, document)
    if one and other:
        value = copy.deepcopy(other[0][other[1]])
        other[0][other[1]] = copy.deepcopy(one[0][one[1]])
        if one[1] in one[0] if isinstance(one[0], dict) else one[1] < len(one[0]):
            one[0][one[1]] = value


def _rename_key(random: Random, document: Document) -> None:
    places = [place for place in _places(document) if isinstance(place[0], dict)]
    if places:
        holder, key = random.choice(places)
        new = random.choice((*TEXTS, *list(holder), key + "x", key.upper()))
        holder[new] = holder.pop(key)


def _add_key(random: Random, document: Document) -> None:
    holders = [document, *(p[0][p[1]] for p in _places(document))]
    found = [each for each in holders if isinstance(each, dict)]
    random.choice(found)[random.choice((*TEXTS, "params", "disabled", "final"))] = _strange(random)


def _link(random: Random, document: Document) -> None:
    links, nodes = document.get("links"), document.get("nodes")
    if not isinstance(links, list) or not isinstance(nodes, dict):
        return
    ends = [end for link in links if isinstance(link, list) for end in link]
    names = [f"{name}.image" for name in nodes]
    if not ends:
        return
    new = [random.choice((*ends, *names, "a.b")), random.choice((*ends, *names, "x", ""))]
    links.insert(random.randint(0, len(links)), random.choice((new, new[::-1], new[:1], [*new, 1])))


def _copy_node(random: Random, document: Document) -> None:
    nodes = document.get("nodes")
    if isinstance(nodes, dict) and nodes:
        name = random.choice(list(nodes))
        nodes[random.choice((f"{name} 2", f" {name}", name.upper(), "ﬁ"))] = copy.deepcopy(
            nodes[name]
        )


EDITS: tuple[Callable[[Random, Document], None], ...] = (
    _replace, _replace, _replace, _delete, _delete, _swap, _rename_key, _add_key, _link, _link,
    _copy_node,
)  # fmt: skip


def _raw_value(random: Random, text: str) -> str:
    """A value, or a piece of text, in place of which stands what Python's json would not write."""
    places = [at for at, sign in enumerate(text) if sign in ":,["]
    at = random.choice(places) + 1 if places else 0
    end = next((at + n for n, sign in enumerate(text[at:]) if sign in ",]}\n"), len(text))
    return text[:at] + random.choice(RAW) + text[end:]


def _doubled_key(random: Random, text: str) -> str:
    places = [at for at, sign in enumerate(text) if sign == "{"]
    if not places:
        return text
    at = random.choice(places) + 1
    key = random.choice(("module", "nodes", "a", "name", ""))
    return text[:at] + f'"{key}": 1, "{key}": 2, ' + text[at:]


def _bytes_damaged(random: Random, content: bytes) -> bytes:
    damaged = bytearray(content)
    for _ in range(random.choice((1, 1, 3, 20))):
        if not damaged:
            break
        at = random.randrange(len(damaged))
        kind = random.randrange(4)
        if kind == 0:
            damaged[at] ^= 1 << random.randrange(8)
        elif kind == 1:
            del damaged[at:]
        elif kind == 2:
            del damaged[at : at + random.randint(1, 40)]
        else:
            damaged[at:at] = random.randbytes(random.randint(1, 8))
    return bytes(damaged)
