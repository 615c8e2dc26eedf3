"""A read-out without a value says why: to the mouse, and to who does not see it."""

import html

from app.editor.evaluation.queries import Answer, Passing
from app.editor.panels.module_body import NONE, ReadoutsView
from core.errors import DataError
from core.modules.declaration import declaration
from focal_plane_bench import CAMERA_SHEET, focal_plane_bench
from nodes.detector.focal_plane import FocalPlane
from panel_hands import NoEvaluator


def test_the_reason_stands_in_tooltip_and_description(qtbot, session, tmp_path):
    view = ReadoutsView(declaration(FocalPlane), "it", NoEvaluator(session), session)
    qtbot.addWidget(view)
    netd = view.values["netd_K"]

    def answer(**outcome):
        view.take(Answer(1, view.owner, view.query, **outcome))
        return netd.accessibleDescription(), html.unescape(netd.toolTip())

    def computed(**changed):
        bench = focal_plane_bench(tmp_path, {**CAMERA_SHEET, **changed}, size=(16, 16))
        return view.query.answer(Passing(bench.engine, bench.plan, bench.work, 1))

    said, tip = answer(value=computed(integration_time_s=0.1))
    assert netd.text() == NONE
    assert "of the full well and is clipped" in said
    assert said in tip
    said, tip = answer(value=computed())
    assert netd.text() != NONE
    assert said == ""
    assert "full well" not in tip
    said, tip = answer(error=DataError("it: no picture comes in"))
    assert netd.text() == NONE
    assert "no picture comes in" in said
    assert said in tip
