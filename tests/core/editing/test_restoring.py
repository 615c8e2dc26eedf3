"""Going back to an earlier state of the whole network, as a step that can be undone."""

from app.run.shipped import shipped_networks
from core.editing.document import Document
from core.editing.fields import set_parameter
from core.editing.nodes import Remove
from core.editing.operation import Restored
from core.network.file import load_network
from nodes.library import standard_library


def test_going_back_is_one_step_with_its_inverse():
    library = standard_library()
    kept = load_network(shipped_networks()["first_steps"], library=library)
    document = Document(kept, library=library)
    document.do(set_parameter("blur", "sigma_x_mrad", 3.0))
    document.do(Remove(("blur",)))
    changed = document.text()
    steps = document.history.position
    assert document.do(Restored(kept, "Go back to Snapshot 1"))
    assert document.network is kept
    assert document.history.position == steps + 1
    assert document.history.undo_text == "Go back to Snapshot 1"
    document.undo()
    assert document.text() == changed
    document.redo()
    assert document.network == kept
    assert not document.do(Restored(kept, "Go back to Snapshot 1"))  # it is there already
