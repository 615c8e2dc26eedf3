"""What the editor makes of files: documents to work on, or one clear line."""

import json

import pytest

from app.editor.window.files import open_named, open_network_file
from app.run.shipped import shipped_networks
from core.chain.engine import Engine
from core.errors import ImagechainError


def network_file(folder, nodes, links=(), **fields):
    document = {"format": "imagechain-network", "version": 1, "nodes": nodes, "links": list(links)}
    path = folder / "network.json"
    path.write_text(json.dumps({**document, **fields}))
    return path


@pytest.mark.thorough(but=4, always=("measured_lens", "kodak_kir310"))
@pytest.mark.parametrize("name", sorted(shipped_networks()))
def test_a_shipped_network_opens_as_a_copy_whose_file_is_not_written_over(name, library):
    document, remark = open_named(name, library=library)
    assert document.path is None
    assert not document.modified
    assert remark == ""
    file = shipped_networks()[name]
    relative = document.text().replace(f"{file.parent}/", "")
    assert relative == file.read_text(encoding="utf-8")


def test_a_copy_of_a_shipped_network_finds_the_files_shipped_with_it(tmp_path, library):
    document = open_named("measured_lens", library=library)[0]
    document.save(tmp_path / "mine.json")
    plan = Engine(library).plan(document.network, folder=tmp_path)
    assert plan.errors() == []


def test_unknown_modules_stay_with_all_they_hold(tmp_path, library):
    nodes = {
        "scene": {"module": "test_scene"},
        "star": {"module": "starlight", "params": {"magnitude": [1, {"deep": None}]}, "colour": 3},
    }
    path = network_file(tmp_path, nodes, [["scene.image", "star.image"]], future={"kept": True})
    document, remark = open_network_file(path, library=library)
    assert "1 unknown module kept as it is: starlight" in remark
    saved = tmp_path / "again.json"
    document.save(saved)
    again = json.loads(saved.read_text())
    assert again["nodes"]["star"] == nodes["star"]
    assert again["links"] == [["scene.image", "star.image"]]
    assert again["future"] == {"kept": True}


def test_a_macro_is_no_unknown_module_but_one_inside_of_it_is(tmp_path, library):
    inside = {"scene": {"module": "test_scene"}}
    camera = {"module": "macro", "macro": {"nodes": inside, "links": []}}
    _, remark = open_network_file(
        network_file(tmp_path, {"camera": camera}, version=2), library=library
    )
    assert remark == ""
    inside |= {"star": {"module": "starlight"}, "moon": {"module": "moonlight"}}
    _, remark = open_network_file(
        network_file(tmp_path, {"camera": camera}, version=2), library=library
    )
    assert remark == "2 unknown modules kept as they are: starlight, moonlight"


def test_a_value_that_is_not_allowed_opens_to_be_mended(tmp_path, library):
    path = network_file(tmp_path, {"j": {"module": "jitter_mtf", "params": {"sigma_mrad": -1}}})
    document, remark = open_network_file(path, library=library)
    assert "1 value not allowed" in remark
    assert document.network.nodes["j"].params["sigma_mrad"] == -1


def test_wiring_that_no_canvas_can_show_is_refused(tmp_path, library):
    nodes = {"a": {"module": "test_scene"}, "j": {"module": "jitter_mtf"}}
    for link, told in (
        (["a.image", "j.magnitude"], "gives image, but the input takes magnitude"),
        (["j.magnitude", "j.magnitude"], "cycle"),
    ):
        with pytest.raises(ImagechainError, match=told):
            open_network_file(network_file(tmp_path, nodes, [link]), library=library)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('{"format": "imagechain-network", "version": 99, "nodes": {}}', "newer Imagechain"),
        ("[" * 100_000, "nested"),
        ("", "network.json"),
    ],
    ids=["newer", "nested", "empty"],
)
def test_a_broken_file_is_one_clear_line(text, told, tmp_path, library):
    path = tmp_path / "network.json"
    path.write_text(text)
    with pytest.raises(ImagechainError, match=told) as caught:
        open_network_file(path, library=library)
    assert "\n" not in str(caught.value)


def test_opening_writes_nothing_and_reads_no_input(tmp_path, library):
    """A hostile file names files everywhere; none of them is touched by opening it."""
    nodes = {
        "in": {"module": "read_image", "params": {"path": "/dev/zero"}},
        "out": {"module": "write_image", "params": {"path": str(tmp_path / "written.png")}},
    }
    path = network_file(tmp_path, nodes, [["in.image", "out.image"]])
    open_network_file(path, library=library)
    assert [each.name for each in tmp_path.iterdir()] == ["network.json"]
