"""What the README installs on a bare Debian is all that the tests call beyond its base system."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PROGRAMS = ("git", "ps", "Xvfb", "xauth", "xdotool", "openbox")


def packages_of_the_readme():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"<!-- system packages -->\n```sh\n(.*?)```", text, re.DOTALL)
    return block.replace("\\\n", " ").partition("--no-install-recommends")[2].split()


@pytest.mark.skipif(shutil.which("dpkg") is None, reason="which package has a program, dpkg knows")
@pytest.mark.parametrize("program", PROGRAMS)
def test_the_readme_names_the_package_of(program):
    path = shutil.which(program)
    assert path, f"the tests call {program}"
    # Debian's /bin is a link to /usr/bin; a package is listed under one of the two.
    names = {path, path.replace("/usr/bin/", "/bin/"), str(Path(path).resolve())}
    listed = subprocess.run(["dpkg", "-S", *names], capture_output=True, text=True, check=False)
    owners = {line.partition(":")[0] for line in listed.stdout.splitlines()}
    assert owners & set(packages_of_the_readme()), f"{program} belongs to {owners or 'none'}"


def test_every_program_that_a_test_asks_for_is_judged():
    wanted = set()
    for file in (ROOT / "tests").rglob("*.py"):
        wanted |= set(re.findall(r"which\(\"([^\"]+)\"\)|= \[\"(ps)\"", file.read_text("utf-8")))
    asked = {name for pair in wanted for name in pair if name} - {"dpkg"}
    optional = {
        "chromium",
        "google-chrome",
        "unshare",
    }  # tests say that they leave out what needs them
    assert asked - optional <= set(PROGRAMS)
