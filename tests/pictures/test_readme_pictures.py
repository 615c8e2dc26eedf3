"""The README's session runs as written; its and the handbook's pictures are the script's."""

import re

import numpy as np
import pytest
from PIL import Image

from child_process import ROOT
from clip_frames import CAPTION_HEIGHT
from readme_pictures import CLIP, CLIP_SIZE, STILLS, make_clip

TEXTS = [
    file.read_text("utf-8")
    for file in (ROOT / "README.md", *(ROOT / "app" / "handbook" / "pages").glob("*.md"))
]
SHOWN = {
    name
    for text in TEXTS
    for name in re.findall(r"(?:\(networks/pictures/|^shipped )([^\s)]+)", text, re.MULTILINE)
}
PLAYED_S = 18, 25
MOST_BYTES = 3_000_000


def frames_of(file, kept=None):
    """The first frames that are to be kept, all seconds, and how often it is played."""
    with Image.open(file) as picture:
        seen, durations = [], []
        for number in range(picture.n_frames):
            picture.seek(number)
            if kept is None or number < kept:
                seen.append(np.asarray(picture.convert("RGB"), dtype=np.int16))
            durations.append(picture.info["duration"])
        return seen, sum(durations) / 1000, picture.info["loop"]


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    """The session with a frame a second: it checks each step's effect itself."""
    file = tmp_path_factory.mktemp("clip") / "short.gif"
    make_clip(file, 1)
    return frames_of(file)[0]


@pytest.mark.thorough  # twenty seconds of a window on a display of its own
def test_the_session_ends_where_it_began(short):
    height = CLIP_SIZE[1]
    assert short[0].shape == (height + CAPTION_HEIGHT, CLIP_SIZE[0], 3)

    def changed(one):
        """The part of the picture's pixels, the viewer's lower half, that differ."""
        picture = np.s_[height // 2 : height - 60, : CLIP_SIZE[0] // 2]
        return (np.abs(short[0] - one)[picture] > 40).any(axis=2).mean()

    assert changed(short[-1]) == 0
    assert max(map(changed, short)) > 0.01


def test_the_clip_that_is_shown_is_small_and_endless():
    file = ROOT / "networks" / "pictures" / CLIP
    assert file.stat().st_size < MOST_BYTES
    seen, seconds, loop = frames_of(file, 1)
    assert PLAYED_S[0] < seconds < PLAYED_S[1]
    assert loop == 0
    assert seen[0].shape == (CLIP_SIZE[1] + CAPTION_HEIGHT, CLIP_SIZE[0], 3)


def test_every_picture_of_the_editor_that_is_shown_is_made_by_the_script():
    made = {name for name in SHOWN if not name.startswith(("bench_", "thumbnail_"))}
    assert made == {CLIP, *STILLS}
    assert all((ROOT / "networks" / "pictures" / name).is_file() for name in SHOWN)
