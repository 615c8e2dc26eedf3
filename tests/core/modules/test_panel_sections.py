"""Sections of a panel as a module's class declares them."""

from typing import Annotated

import pytest

from core.chain.wires import Image
from core.modules.declaration import Module, declaration
from core.modules.panel_sections import Offer, Section
from core.modules.parameters import Param


def declared(*sections, shared=()):
    """A module with the parameters a, b and c in these sections."""

    class Base(Module):
        a: Annotated[float, Param("first")] = 1.0
        b: Annotated[float, Param("second")] = 2.0

        panel = shared

    class Made(Base, key="made", title="Made", group="Tests"):
        """Do nothing."""

        c: Annotated[float, Param("third")] = 3.0
        if sections:
            panel = sections

        def run(self, image: Image) -> None:
            """Nothing."""

    return declaration(Made)


def test_without_sections_all_stand_together():
    assert declared().panel == (Section("", ("a", "b", "c")),)


def test_sections_stand_in_their_order_and_parameters_of_none_below():
    sections = (Section("Second", ("b",), page="P"), Section("First", ("a",)))
    assert declared(*sections).panel == (*sections, Section("", ("c",)))


def test_a_base_shares_its_sections():
    base = (Section("Both", ("a", "b")),)
    assert declared(shared=base).panel == (*base, Section("", ("c",)))


@pytest.mark.parametrize(
    ("sections", "wrong"),
    [
        ((Section("", ("a", "d")),), "name d; allowed: each of a, b, c once"),
        ((Section("", ("a", "b")), Section("", ("b",))), "name b; allowed"),
        ((Section("", ("a",), shown_when=("mode", ("on",))),), "name mode; allowed"),
        ((Section("", ("a",), offer=Offer("a", "e", {})),), "name e; allowed"),
    ],
    ids=["unknown", "twice", "condition", "offer"],
)
def test_a_wrong_name_is_refused_with_its_class(sections, wrong):
    with pytest.raises(TypeError, match=f"Made: the sections of the panel {wrong}"):
        declared(*sections)
