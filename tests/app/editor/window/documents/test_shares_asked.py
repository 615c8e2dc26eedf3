"""Before the editor reads from another computer that a network names, it asks."""

from __future__ import annotations

import json

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QMessageBox

from app.editor.allowed_shares import Shares
from core.editing.operations import set_parameter

YES, NO = QMessageBox.StandardButton.Yes, QMessageBox.StandardButton.No


@pytest.fixture
def opened(window, idle, tmp_path):
    """A network whose picture lies below a name that Windows takes for one of another computer.

    Here that name is one of a plain file, so that reading it would succeed.
    """
    np.save(tmp_path / "a.npy", np.ones((4, 4)))
    params = {"path": f"/{tmp_path}/a.npy"}
    content = {"format": "imagechain-network", "version": 1}
    content["nodes"] = {"read": {"module": "read_image", "params": params}}
    (tmp_path / "net.json").write_text(json.dumps(content))
    window.session.shares = Shares(windows=True)
    assert window.files.open_now(str(tmp_path / "net.json"))
    idle(window)
    return window


def boxes(window):
    return [box for box in window.findChildren(QMessageBox) if box.isVisible()]


def answer(window, button):
    [box] = boxes(window)
    QTest.mouseClick(box.button(button), Qt.MouseButton.LeftButton)


def test_nothing_is_read_before_it_is_allowed(opened, idle, tmp_path):
    server = tmp_path.parts[1]
    [box] = boxes(opened)
    assert box.text() == f"The network names files on another computer: {server}"
    assert box.defaultButton() is box.button(NO)
    planned = opened.evaluator.plan.nodes["read"]
    assert planned.module is None
    assert f"another computer, {server}" in opened.evaluator.badges["read"].text
    assert not opened.session.document.modified
    answer(opened, YES)
    idle(opened)
    assert "read" not in opened.evaluator.badges
    assert opened.evaluator.plan.nodes["read"].outputs["image"].shape == (4, 4)
    assert opened.session.network.nodes["read"].params["path"] == f"/{tmp_path}/a.npy"


def test_no_is_remembered_for_the_session(opened, idle, tmp_path):
    answer(opened, NO)
    idle(opened)
    opened.session.do(set_parameter("read", "scale", 2.0))
    opened.files.open_now(str(tmp_path / "net.json"))
    idle(opened)
    assert boxes(opened) == []
    assert opened.evaluator.plan.nodes["read"].module is None


def test_each_computer_is_asked_for_in_turn(opened, idle, tmp_path):
    opened.session.do(set_parameter("read", "path", "//other/share/a.npy"))
    answer(opened, NO)
    [box] = boxes(opened)
    assert box.text().endswith(": other")
    answer(opened, NO)
    idle(opened)
    assert boxes(opened) == []


def test_elsewhere_nothing_is_asked(window, idle, tmp_path):
    np.save(tmp_path / "a.npy", np.ones((4, 4)))
    window.files.new()
    drop = {"format": "imagechain-network", "version": 1}
    drop["nodes"] = {"read": {"module": "read_image", "params": {"path": f"/{tmp_path}/a.npy"}}}
    (tmp_path / "net.json").write_text(json.dumps(drop))
    window.session.shares = Shares(windows=False)
    assert window.files.open_now(str(tmp_path / "net.json"))
    idle(window)
    assert boxes(window) == []
    assert window.evaluator.plan.nodes["read"].module is not None
