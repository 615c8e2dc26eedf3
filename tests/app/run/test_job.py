"""Jobs of background runs, as text and as the runs they consist of; and what they report."""

from pathlib import Path

import pytest

from app.run.job import Job, message_line, read_message

HERE = Path("/home/me")


def job(kind, **given):
    return Job(kind, "{}", HERE, HERE / "net.json", HERE / "out", **given)


@pytest.mark.parametrize(
    "made",
    [
        job("frames", frames=12),
        job("sweep", target="blur.sigma_x_mrad", values=(0.1, 0.25, 3), log=True, report=True),
        job("files", target="scene.path", values=("a.tif", "b\u00fc\udcff.tif")),
        Job("report", "line\nline", HERE, None, HERE / "r.html", chosen=(HERE / "\udcfe.tif",)),
    ],
    ids=lambda made: made.kind,
)
def test_a_job_is_one_line_and_comes_back_the_same(made):
    text = message_line(made)
    assert "\n" not in text
    assert text.isascii()
    assert read_message(text) == made


def test_a_sweep_has_a_folder_for_each_value():
    variants = job("sweep", target="blur.sigma_x_mrad", values=(0.1, 1 / 3, 2)).variants
    assert variants == (
        ("blur.sigma_x_mrad=0.1", 0.1),
        ("blur.sigma_x_mrad=0.333333", 1 / 3),
        ("blur.sigma_x_mrad=2", 2),
    )
    assert job("sweep", target="blur.sigma_x_mrad", values=(1,), pictures=False).variants == ()


def test_folders_of_files_are_apart_and_can_be_made_anywhere():
    """Of one stem in several folders, or in large letters, which some systems take for small."""
    values = ("a/scene.tif", "b/Scene.png", "scene-1.exr", "c/what?:now.tif", "c/dot..tif", "d/.x")
    names = [name for name, _ in job("files", target="in.path", values=values).variants]
    assert names == ["scene-2", "Scene-3", "scene-1", "what__now", "dot", "x"]
    inside = job("sweep", target="camera/blur.sigma", values=(0.5,)).variants
    assert [name for name, _ in inside] == ["camera_blur.sigma=0.5"]


@pytest.mark.parametrize("line", ["hello", "imagechain-job {", "imagechain-job gASV"])
def test_other_lines_say_nothing(line):
    assert read_message(line) is None
