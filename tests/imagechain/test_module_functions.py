"""`ic.modules`: complete signatures, and a stub that says the same."""

import inspect

import pytest

import imagechain as ic
from core.modules.declaration import declaration
from imagechain.parts.module_stub import STUB, stub_text
from nodes.library import standard_library


def test_the_stub_is_up_to_date():
    """Else run ``python -m imagechain.parts.module_stub``."""
    assert STUB.read_text(encoding="utf-8") == stub_text(standard_library())


def test_every_module_has_its_parameters_with_units_and_defaults():
    assert dir(ic.modules) == sorted(standard_library())
    for key, module in standard_library().items():
        function, declared = getattr(ic.modules, key), declaration(module)
        arguments = inspect.signature(function).parameters
        assert list(arguments) == [parameter.name for parameter in declared.parameters]
        assert all(one.kind is inspect.Parameter.KEYWORD_ONLY for one in arguments.values())
        assert dict(function().params) == {}
        given = {name: one.default for name, one in arguments.items()}
        assert module.build(function(**given).params) == module.build({})
        text = inspect.getdoc(function)
        assert text.startswith(declared.summary[:40])
        for parameter in declared.parameters:
            assert f"\n{parameter.name} : " in text
            assert f"[{parameter.param.unit}]" in text or not parameter.param.unit


def test_a_value_that_is_not_allowed_is_refused_at_once():
    message = "sigma_x_mrad = -1 mrad is not allowed: must be a number of at least 0"
    with pytest.raises(ic.ParameterError) as caught:
        ic.modules.gaussian_mtf(sigma_x_mrad=-1)
    assert str(caught.value) == message
    assert caught.value.__cause__ is None
    assert caught.value.__suppress_context__ or caught.value.__context__ is None
    with pytest.raises(ic.ParameterError, match=r"did you mean sigma_x_mrad\?"):
        ic.modules.gaussian_mtf(sigma_x_mra=1)
    with pytest.raises(AttributeError, match=r"did you mean gaussian_mtf\?"):
        ic.modules.gausian_mtf()
