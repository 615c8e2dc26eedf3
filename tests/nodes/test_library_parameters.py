"""Every registered module takes a parameter or refuses it in one line."""

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from battery_settings import EXAMPLES
from core.errors import ParameterError
from core.evaluation.recipes import content_key
from core.modules.parameters import plain
from library_battery import DECLARED, LIBRARY, assert_clear
from thorough import examples


@pytest.mark.parametrize("key", LIBRARY)
class TestParameters:
    @pytest.mark.parametrize("given_values", ["defaults", "example"])
    def test_json_round_trip(self, key, given_values):
        module = LIBRARY[key].build({} if given_values == "defaults" else EXAMPLES[key])
        text = json.dumps({n: plain(v) for n, v in module.values().items()}, allow_nan=False)
        again = LIBRARY[key].build(json.loads(text))
        assert again == module
        assert content_key(again.values()) == content_key(module.values())

    def test_whole_numbers_and_floats_are_one_value(self, key):
        for parameter in DECLARED[key].parameters:
            if parameter.kind not in ("number", "integer"):
                continue
            allowed = 0
            for whole in (0, 1, 2, 3, 8, 400):
                try:
                    module = LIBRARY[key].build({parameter.name: whole})
                except ParameterError:
                    with pytest.raises(ParameterError):
                        LIBRARY[key].build({parameter.name: float(whole)})
                    continue
                allowed += 1
                other = LIBRARY[key].build({parameter.name: float(whole)})
                minus = LIBRARY[key].build({parameter.name: -0.0}) if whole == 0 else other
                keys = {content_key(m.values()) for m in (module, other, minus)}
                assert len(keys) == 1, (parameter.name, whole)
            assert allowed, parameter.name

    @settings(max_examples=examples(25), deadline=None, derandomize=True)
    @given(data=st.data())
    def test_any_value_is_taken_or_refused_in_one_line(self, key, data):
        anything = st.one_of(
            st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=5),
            st.lists(st.floats() | st.integers(), max_size=3), st.integers(10**300, 10**400),
            st.sampled_from([1e308, -1e308, 5e-324, 2**63, -(2**63), "1", b"1", {}]),
        )  # fmt: skip
        for parameter in DECLARED[key].parameters:
            value = data.draw(anything)
            try:
                module = LIBRARY[key].build({parameter.name: value})
            except ParameterError as error:
                assert_clear(error, None)
                continue
            stored = json.loads(json.dumps(plain(getattr(module, parameter.name)), allow_nan=False))
            assert LIBRARY[key].build({parameter.name: stored}) == module
