"""The page that a word names."""

from __future__ import annotations

from app.handbook.module_examples import PAGES
from app.handbook.written_pages import module_address, page_titles
from core.modules.declaration import Library, declaration


def find_page(word: str, library: Library) -> tuple[str | None, list[str]]:
    """Address of the page, or None; and the names by which pages can be named.

    A name or a title comes first, then a title that begins with the word or has it, then the page
    that has it most often.

    Parameters
    ----------
    word : str
        Of any case.
    library : mapping
        The modules.
    """
    titles = {f"{name}.html": title for name, title in page_titles().items()}
    texts = {
        f"{name}.html": (PAGES / f"{name}.md").read_text(encoding="utf-8") for name in page_titles()
    }
    names = {name: f"{name}.html" for name in page_titles()}
    for key, module in library.items():
        declared = declaration(module)
        address = module_address(key)
        names[key], titles[address] = address, declared.title
        parameters = " ".join(f"{p.name} {p.param.text}" for p in declared.parameters)
        texts[address] = f"{declared.text} {parameters}"
    wanted = word.casefold().strip()
    by_name = {name.casefold(): address for name, address in names.items()}
    by_name |= {title.casefold(): address for address, title in titles.items()}
    if wanted in by_name:
        return by_name[wanted], list(names)
    underlined = wanted.replace(" ", "_").replace("-", "_")
    if underlined in by_name:
        return by_name[underlined], list(names)
    ranked = sorted(
        titles,
        key=lambda address: (
            not titles[address].casefold().startswith(wanted),
            wanted not in titles[address].casefold(),
            -texts[address].casefold().count(wanted),
        ),
    )
    best = ranked[0]
    has = wanted in titles[best].casefold() or wanted in texts[best].casefold()
    return (best if wanted and has else None), list(names)
