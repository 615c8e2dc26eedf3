"""Every registered module is declared and documented."""

from pathlib import Path

import pytest

from core.errors import unit_of
from library_battery import DECLARED, LIBRARY
from nodes import library

PORT_TYPES = {"image", "magnitude", "phase", "context", "pupil", "transfer", "curve", "table"}


def test_no_two_files_of_modules_have_one_name():
    """A key is the name of its file: the second would take the place of the first."""
    files = Path(library.__file__).read_text(encoding="utf-8").partition("OURS")[0]
    assert len(library.OURS) == files.count('",\n')


@pytest.mark.parametrize("key", LIBRARY)
class TestDeclared:
    def test_says_what_it_is(self, key):
        declared = DECLARED[key]
        assert declared.key == key == LIBRARY[key].key
        assert declared.title
        assert declared.group
        assert declared.version >= 1
        assert declared.summary.endswith(".")
        assert len(declared.summary) <= 120
        assert not declared.text.startswith(LIBRARY[key].__name__ + "(")  # dataclass' own words

    def test_ports_are_typed(self, key):
        declared = DECLARED[key]
        assert declared.inputs or declared.outputs
        for port in (*declared.inputs, *declared.outputs):
            assert port.types
            assert set(port.types) <= PORT_TYPES
        for port in declared.outputs:
            assert len(port.types) == 1
        names = [port.name for port in declared.inputs]
        assert len(set(names)) == len(names)
        assert declared.outputs or declared.sink

    def test_parameters_are_documented(self, key):
        for parameter in DECLARED[key].parameters:
            assert parameter.param.text.strip()
            assert not parameter.required

    def test_units_in_names_and_declarations_agree(self, key):
        declared = DECLARED[key]
        named = [(p.name, p.param.unit) for p in declared.parameters]
        named += [(r.name, r.unit) for r in declared.readouts]
        more = {"zernike_waves": "waves rms", "display_cd_m2": "cd/m²"}
        for name, unit in named:
            assert unit == more.get(name, unit_of(name)) or not unit_of(name), name

    def test_readouts_are_documented(self, key):
        declared = DECLARED[key]
        ports = {port.name for port in declared.inputs} | {"outputs"}
        names = [readout.name for readout in declared.readouts]
        assert len(set(names)) == len(names)
        for readout in declared.readouts:
            assert readout.meaning.endswith("."), readout.name
            assert set(readout.needs) <= ports
