"""A file may put things further away than Qt can count pixels: the canvas draws what it can."""

import json

import pytest

from app.editor.window.files import open_network_file

FAR = (1e308, -2e9)


def written(far):
    """A network with nodes, a dot, a backdrop and a note so far away, inside of a macro too."""
    ground = {"title": "Far", "x": far, "y": 0, "width": 300, "height": 200}
    marks = {
        "layout": {"scene": [0, 0], "init": [far, far]},
        "wire_dots": [{"link": ["scene.image", "init.image"], "points": [[50, far]]}],
        "backdrops": [
            ground,
            {**ground, "x": 0, "width": abs(far), "kind": "note"},
            {**ground, "x": 0, "title": "Near"},
        ],
    }
    nodes = {"scene": {"module": "test_scene"}, "init": {"module": "init_trans"}}
    body = {"nodes": nodes, "links": [["scene.image", "init.image"]], **marks}
    nodes = {**nodes, "camera": {"module": "macro", "macro": body}}
    return json.dumps({"format": "imagechain-network", "version": 2, **body, "nodes": nodes})


@pytest.mark.parametrize("far", FAR)
def test_a_file_with_far_places_is_drawn_and_worked_on(window, library, tmp_path, qtbot, far):
    path = tmp_path / "far.json"
    path.write_text(written(far))
    assert window.files.open_now(str(path))
    for name in ("frame", "select_all", "arrange", "align_left", "undo", "undo", "zoom_in"):
        window.actions_by_name[name].trigger()
        assert not window.grab().isNull()
    window.level.enter("camera")
    assert not window.grab().isNull()
    window.level.leave()
    window.level.select(["camera"])
    window.actions_by_name["ungroup"].trigger()
    assert not window.grab().isNull()
    assert window.session.save()
    assert open_network_file(path, library=library)[0].text() == path.read_text()
