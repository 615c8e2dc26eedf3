"""How panels group parameters: all of them, once, and none hidden that counts."""

from collections import Counter

import pytest

from core.modules.declaration import declaration
from nodes.library import standard_library

LIBRARY = standard_library()
DECLARED = {key: declaration(module) for key, module in LIBRARY.items()}
CONDITIONAL = [
    pytest.param(key, section, id=f"{key}-{'-'.join(section.parameters)}")
    for key, declared in DECLARED.items()
    for section in declared.panel
    if section.shown_when
]


def test_every_parameter_stands_on_the_panel_once():
    for key, declared in DECLARED.items():
        placed = Counter(name for section in declared.panel for name in section.parameters)
        assert placed == Counter(parameter.name for parameter in declared.parameters), key


@pytest.mark.parametrize(("key", "section"), CONDITIONAL)
def test_what_shows_a_section_is_a_choice_that_is_always_shown(key, section):
    name, values = section.shown_when
    parameter = DECLARED[key].parameter(name)
    assert parameter.kind == "choice"
    assert set(values) < set(parameter.choices)
    home = next(other for other in DECLARED[key].panel if name in other.parameters)
    assert home.shown_when is None
    assert home.page == section.page


def test_the_published_order_of_the_initialization_panel():
    placed = [name for section in DECLARED["init_trans"].panel for name in section.parameters]
    published = ["detector_x_um", "detector_y_um", "focal_length_mm", "f_number", "range_m"]
    assert placed[:7] == [*published, "fill_x", "fill_y"]  # fig. 4.3


def test_the_published_order_of_the_electronics_panel():
    sections = DECLARED["electronics_noise"].panel
    placed = [name for section in sections for name in section.parameters]
    published = ["cut_on_um", "cut_off_um", "region", "material", "optics_transmission"]
    published += ["filter_transmission", "bits", "seed_mode", "seed"]  # fig. 4.42
    assert [name for name in placed if name in published] == published
