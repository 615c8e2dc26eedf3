"""The fenced blocks of a page of Markdown."""

from markdown_it import MarkdownIt

from core.records import dataclass


@dataclass(frozen=True)
class Block:
    """A block of code, of output, or of a file's content."""

    kind: str
    name: str
    text: str


def blocks_of(text: str) -> list[Block]:
    """The fenced blocks of a page, in order."""
    blocks = []
    for token in MarkdownIt("commonmark").parse(text):
        if token.type == "fence":
            kind, _, name = token.info.strip().partition(" ")
            blocks.append(Block(kind, name.strip(), token.content))
    return blocks
