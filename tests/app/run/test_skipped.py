"""The error budget of a run, and what its outputs say was not computed."""

import json
import re

import numpy as np
import pytest


def skipped(report, kind):
    """What a report says of that kind, by node."""
    return {
        node: each
        for node, listed in report["skipped"].items()
        for each in listed
        if each["kind"] == kind
    }


def economy(page):
    """The rows of the section on what was not computed."""
    section = page.partition("<h2>Skipped computations</h2>")[2].partition("</table>")[0]
    return [re.findall(r"<td>(.*?)</td>", row) for row in section.split("<tr>")[2:]]


def test_says_what_was_not_computed(imagechain, write, small, tmp_path):
    small["nodes"]["blur"]["disabled"] = True
    words = ["--set", "jitter.sigma_mrad=0", "--report", "r.json", "--report", "r.html"]
    imagechain("run", write(small), *words)
    report = json.loads((tmp_path / "r.json").read_text())
    assert list(skipped(report, "identity")) == ["jitter"]
    assert list(skipped(report, "disabled")) == ["blur"]
    assert skipped(report, "below_budget") == skipped(report, "unchanged") == {}
    unseen = {node: each["ports"] for node, each in skipped(report, "unseen").items()}
    assert unseen == {"init": ["magnitude", "phase"], "back": ["image"]}
    page = (tmp_path / "r.html").read_text()
    assert [where for _, _, where in economy(page)] == [
        "blur",
        "jitter",
        "init (magnitude, phase), back (image)",
    ]
    assert "neutral: skipped" in page


def test_says_what_the_budget_left_out(imagechain, write, small, tmp_path):
    words = ["--set", "jitter.sigma_mrad=1e-6", "--report", "r.json", "--report", "r.html"]
    done = imagechain("run", write(small), *words)
    report = json.loads((tmp_path / "r.json").read_text())
    assert report["run"]["tolerance"] == 2.0**-23 / 8
    assert skipped(report, "identity") == {}
    # 1 − exp(−2π²σ²ρ²) in the corner, next to Nyquist: about 2π²·10⁻¹²·(0.458² + 0.458²)
    bound = skipped(report, "below_budget")["jitter"]["bound"]
    assert bound == pytest.approx(4 * np.pi**2 * 1e-12 * 0.458366**2, rel=0.06)
    page = (tmp_path / "r.html").read_text()
    text = f"{bound:.1e}".replace("e-12", "·10⁻¹²")
    assert f"left out: effect at most {text}" in page
    assert economy(page)[0][2] == f"jitter (at most {text} of the range)"
    told = "left out within the error budget of 1.49e-08 of the picture's range: jitter "
    assert f"{told}(effect at most {bound:.2g})\n" in done.stdout


def gaussian_corner(sigma_mrad):
    """1 − H of a round Gaussian in the corner of the small network's band."""
    corner = 1000 * np.radians(3.0) / 48, 1000 * np.radians(2.5) / 40
    squares = sum((0.5 / interval) ** 2 for interval in corner)
    return -np.expm1(-2 * np.pi**2 * sigma_mrad**2 * squares)


def test_the_tolerance_decides_what_is_left_out(imagechain, works, write, small, tmp_path):
    small["nodes"]["blur"]["params"] = {"sigma_x_mrad": 0.05, "sigma_y_mrad": 0.05}
    small["nodes"]["jitter"]["params"] = {"sigma_mrad": 0.02}
    budget = 1.2 * gaussian_corner(0.02)  # enough for the jitter
    assert budget < gaussian_corner(0.05)  # not for the blur
    write(small)
    pictures = {}
    for name, words, gone in (
        ("default", [], []),
        ("exact", ["--tolerance", "0"], []),
        ("one", ["--tolerance", repr(float(budget))], ["jitter"]),
        ("all", ["--tolerance=.999"], ["blur", "jitter"]),
    ):
        files = ["--report", f"{name}.json", "--save", f"back.image={name}.npy"]
        done = works("run", "net.json", "--precision", "single", *words, *files)
        report = json.loads((tmp_path / f"{name}.json").read_text())
        assert list(skipped(report, "below_budget")) == gone
        assert ("left out within" in done.stdout) == bool(gone)
        pictures[name] = np.load(tmp_path / f"{name}.npy").astype(float)
    imagechain("run", "net.json", "--precision", "single", "--save", "scene.image=scene.npy")
    scene = np.load(tmp_path / "scene.npy").astype(float)
    np.testing.assert_array_equal(pictures["default"], pictures["exact"])
    rounding = 2e-6
    assert np.abs(pictures["all"] - scene).max() <= rounding * np.abs(scene).max()
    rms = np.sqrt(np.mean((pictures["one"] - pictures["exact"]) ** 2))
    assert rounding * np.ptp(scene) < rms <= budget * np.ptp(scene)
