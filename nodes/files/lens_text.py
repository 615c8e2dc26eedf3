"""Text of a lens' file, in the encodings that optical design and measuring programs write."""

from __future__ import annotations

import codecs
from pathlib import Path

from core.errors import FileError
from nodes.files.common.size_limits import refuse_oversized_text

_WIDE = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


def lens_lines(path: Path, *, what: str) -> list[str]:
    """Lines of a text: UTF-8, UTF-16 with its mark or, of Latin letters, without, or Latin-1.

    Parameters
    ----------
    path
        A file that is there and not empty.
    what
        What is expected in it, for the message.

    Raises
    ------
    FileError
        The file is no text, too long for the memory, or cannot be read.
    """
    refuse_oversized_text(path)
    try:
        content = path.read_bytes()
    except OSError as error:
        raise FileError(f"{path}: {error.strerror or error}") from error
    try:
        text = _decoded(content)
    except UnicodeDecodeError as error:
        raise FileError(f"{path}: is no text of {what}") from error
    if any(ord(sign) < 32 and sign not in "\t\n\r\f\x1a" for sign in text):
        raise FileError(f"{path}: is no text of {what}")
    return text.rstrip("\x1a").splitlines()


def _decoded(content: bytes) -> str:
    if content.startswith(_WIDE):
        return content.decode("utf-16")
    if content[1:2] == b"\0" and content[3:4] in (b"\0", b""):
        return content.decode("utf-16-le")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        # µ of older programs; whatever is no text shows by its control characters.
        return content.decode("latin-1")
