"""Files on other computers: which names lead there, and what the command line does with them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from app.permission.shares import check_shares, named_shares, share_server
from core.errors import NetworkError
from core.network.file import parse_network
from nodes.library import standard_library

LIBRARY = standard_library()
SHARES = {
    r"\\server\share\a.png": "server",
    "//server/share/a.png": "server",
    r"\/Server/share\a.png": "server",
    r"\\10.0.0.1\c$": "10.0.0.1",
    r"\\server@SSL\DavWWWRoot\a.png": "server@ssl",
    r"\\?\UNC\server\share\a.png": "server",
    r"//?/unc/server/share/a.png": "server",
    r"\\.\UNC\server\share\a.png": "server",
    r"\??\UNC\server\share\a.png": "server",
    r"\\?\GLOBALROOT\Device\Mup\server\share": "globalroot",
    r"\\server": "server",
    r"\\\server\share": "server",
}
PLAIN = ["a.png", "sub/a.png", r"sub\a.png", "/a.png", r"\a.png", "C:/a.png", r"C:\a.png", ".."]
PLAIN += [r"\\?\C:\a.png", r"\\.\d:\a.png", "", "//", "http://server/a.png"]


@pytest.mark.parametrize(("path", "server"), SHARES.items())
def test_names_of_shares(path, server):
    assert share_server(path, windows=True) == server
    assert share_server(path, windows=False) is None


@pytest.mark.parametrize("path", PLAIN)
def test_names_of_files_here(path):
    assert share_server(path, windows=True) is None
    assert share_server(path, windows=False) is None


def network(**paths):
    modules = {"read": "read_image", "pupil": "exit_pupil", "out": "write_image"}
    nodes = {name: {"module": modules[name], "params": {"path": p}} for name, p in paths.items()}
    text = json.dumps({"format": "imagechain-network", "version": 1, "nodes": nodes})
    return parse_network(text, library=LIBRARY)


def test_every_file_name_of_a_network_counts():
    found = named_shares(
        network(read="//one/s/a.png", pupil=r"\\two\s\a.npy", out="//one/s/b.tif"),
        LIBRARY,
        windows=True,
    )
    assert found == {("read", "path"): "one", ("pupil", "path"): "two", ("out", "path"): "one"}
    assert named_shares(network(read="//one/s/a.png"), LIBRARY, windows=False) == {}


def test_the_command_line_refuses_computers_that_it_does_not_name():
    given = network(read="//one/s/a.png")
    with pytest.raises(NetworkError) as caught:
        check_shares(given, LIBRARY, windows=True)
    assert str(caught.value) == (
        "read: path = //one/s/a.png lies on another computer, one, that the command line "
        "does not name: --set read.path=… with that path allows it"
    )
    check_shares(given, LIBRARY, windows=False)
    check_shares(given, LIBRARY, given=[("read", "path")], windows=True)
    check_shares(given, LIBRARY, places=[Path("//ONE/nets/net.json")], windows=True)
    with pytest.raises(NetworkError):
        check_shares(given, LIBRARY, given=[("read", "band")], windows=True)
    with pytest.raises(NetworkError):
        check_shares(given, LIBRARY, places=[Path("//two/nets"), Path("/one")], windows=True)


def test_elsewhere_two_slashes_are_a_plain_path(imagechain, write, small, tmp_path):
    small["nodes"]["out"] = {"module": "write_image", "params": {"path": f"/{tmp_path}/a.tif"}}
    small["links"].append(["back.image", "out.image"])
    done = imagechain("run", write(small))
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "a.tif").is_file()
