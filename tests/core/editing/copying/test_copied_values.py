"""Values of a node as text, and on another node; expected values read off the declarations."""

import json

import pytest

from core.editing.copying.copied_values import copied_values, pasted_values
from core.editing.document import Document
from core.editing.fields import set_parameter
from core.errors import NetworkError
from core.modules.declaration import declaration
from core.modules.parameters import plain
from core.network.linked_values import expression, with_values
from core.network.network import Network, Node


def network_of(*nodes):
    return Network(nodes={node.id: node for node in nodes})


@pytest.fixture
def declared_in(library):
    def of(network):
        return lambda name: (
            declaration(library[network.nodes[name].module])
            if network.nodes[name].module in library
            else None
        )

    return of


@pytest.fixture
def paste(library, declared_in):
    def do(network, source, *targets, text=None):
        of = declared_in(network)
        if text is None:
            text = copied_values(network.nodes[source], of(source))

        def faults_after(setting, places):
            faults = with_values(setting.apply(network), library=library).faults
            return {(name, one.parameter): one for name in faults for one in faults[name]
                    if (name, one.parameter) in places}  # fmt: skip

        return pasted_values(text, targets, network, declaration_of=of, faults_after=faults_after)

    return do


BLUR = Node("blur", "gaussian_mtf", {"sigma_x_mrad": 0.3, "sigma_y_mrad": 0.5})


def test_the_text_is_json_with_module_names_and_units(library):
    text = json.loads(copied_values(BLUR, declaration(library["gaussian_mtf"])))
    parameters = declaration(library["gaussian_mtf"]).parameters
    assert text["module"] == "gaussian_mtf"
    assert text["node"] == "blur"
    assert list(text["values"]) == [parameter.name for parameter in parameters]
    assert text["values"]["sigma_x_mrad"] == 0.3
    assert text["units"]["sigma_x_mrad"] == "mrad"


def moved_from_default(parameter):
    """A number that the parameter may have, and has not by default."""
    low = parameter.param.low if parameter.param.low is not None else 0.0
    high = parameter.param.high if parameter.param.high is not None else low + 8.0
    return next(
        v for share in (0.375, 0.625) if (v := low + share * (high - low)) != parameter.default
    )


def test_every_module_gives_its_values_to_another_of_its_kind(library, paste):
    for key, module in library.items():
        values = {
            parameter.name: moved_from_default(parameter)
            for parameter in declaration(module).parameters
            if parameter.kind == "number"
        }
        if values:
            network = network_of(Node("one", key, values), Node("two", key))
            done = paste(network, "one", "two")
            assert not done.left_out, key
            assert done.operation.apply(network).nodes["two"].params == values, key


def test_what_is_at_its_default_there_goes_back_to_its_default(library, paste):
    other = Node("other", "gaussian_mtf", {"sigma_x_mrad": 0.9, "sigma_y_mrad": 0.9})
    plain_blur = Node("blur", "gaussian_mtf", {"sigma_x_mrad": 0.3})
    network = network_of(plain_blur, other)
    after = paste(network, "blur", "other").operation.apply(network)
    assert dict(after.nodes["other"].params) == {"sigma_x_mrad": 0.3}


def test_it_is_one_step_that_can_be_undone(library, paste):
    network = network_of(BLUR, Node("a", "gaussian_mtf"), Node("b", "gaussian_mtf"))
    document = Document(network, library=library)
    before = document.text()
    document.do(paste(network, "blur", "a", "b").operation)
    assert document.history.last == 1
    assert document.network.nodes["a"].params == document.network.nodes["b"].params == BLUR.params
    document.undo()
    assert document.text() == before


def test_where_nothing_fits_it_is_said_what_is_missing(paste):
    init = Node("init", "init_trans", {"focal_length_mm": 150.0, "f_number": 3.0})
    with pytest.raises(NetworkError, match="no value fits blur: Gaussian MTF has no "):
        paste(network_of(init, Node("blur", "gaussian_mtf")), "init", "blur")


def shared_keys(library):
    """Two modules that share a number but not all their parameters."""
    declared = {key: declaration(module) for key, module in library.items()}
    for one, left in declared.items():
        for other, right in declared.items():
            keys = {
                p.name: p
                for p in left.parameters
                if p.kind == "number" and (twin := right.parameter(p.name)) and one != other
                and twin.param == p.param and not p.required and not p.empty
            }  # fmt: skip
            missing = [p.name for p in left.parameters if right.parameter(p.name) is None]
            if keys and missing:
                yield one, other, next(iter(keys.values())), missing


def test_parameters_of_the_same_key_go_to_other_modules(library, paste):
    tried = 0
    for one, other, parameter, missing in shared_keys(library):
        value = moved_from_default(parameter)
        network = network_of(Node("one", one, {parameter.name: value}), Node("two", other))
        done = paste(network, "one", "two")
        after = done.operation.apply(network)
        assert after.nodes["two"].params.get(parameter.name) == value, (one, other)
        assert f"two.{parameter.name}" in done.taken
        assert any(missing[0] in reason for reason in done.left_out)
        tried += 1
    assert tried


def test_a_value_that_is_not_allowed_there_is_left_out_with_the_reason(paste):
    text = json.dumps({
        "format": "imagechain-values", "version": 1, "module": "gaussian_mtf",
        "values": {"sigma_x_mrad": -3.0, "sigma_y_mrad": 0.25},
    })  # fmt: skip
    network = network_of(BLUR)
    done = paste(network, "", "blur", text=text)
    assert done.taken == ("blur.sigma_y_mrad",)
    (reason,) = done.left_out
    assert "sigma_x_mrad = -3.0 mrad is not allowed" in reason
    after = done.operation.apply(network)
    assert dict(after.nodes["blur"].params) == {"sigma_x_mrad": 0.3, "sigma_y_mrad": 0.25}


def test_a_value_in_another_unit_is_left_out(paste):
    text = json.dumps({
        "format": "imagechain-values", "version": 1, "module": "other",
        "values": {"sigma_x_mrad": 0.2, "sigma_y_mrad": 0.25}, "units": {"sigma_x_mrad": "deg"},
    })  # fmt: skip
    done = paste(network_of(BLUR), "", "blur", text=text)
    assert done.left_out == ("sigma_x_mrad is in mrad there, not in deg",)


def test_expressions_are_pasted_as_expressions(library, paste):
    init = Node("init", "init_trans", {"f_number": 2.0})
    linked = Node("blur", "gaussian_mtf", {"sigma_x_mrad": expression("init.f_number * 0.1")})
    network = network_of(init, linked, Node("other", "gaussian_mtf"))
    after = paste(network, "blur", "other").operation.apply(network)
    assert after.nodes["other"].params["sigma_x_mrad"] == {"expression": "init.f_number * 0.1"}


def test_an_expression_that_would_follow_itself_is_left_out(paste):
    init = Node("init", "init_trans", {"f_number": 2.0})
    one = Node("one", "gaussian_mtf", {"sigma_x_mrad": expression("two.sigma_x_mrad * 2")})
    two = Node("two", "gaussian_mtf", {"sigma_x_mrad": 0.5})
    network = network_of(init, one, two)
    done = paste(network, "one", "two")
    assert "two.sigma_x_mrad" not in done.taken
    assert any("it follows itself" in reason for reason in done.left_out)
    assert done.operation.apply(network).nodes["two"].params["sigma_x_mrad"] == 0.5


def test_an_expression_that_names_what_is_not_there_is_left_out(paste):
    text = json.dumps({
        "format": "imagechain-values", "version": 1, "module": "gaussian_mtf",
        "values": {"sigma_x_mrad": {"expression": "lens.f_number"}, "sigma_y_mrad": 0.25},
    })  # fmt: skip
    done = paste(network_of(BLUR), "", "blur", text=text)
    assert done.taken == ("blur.sigma_y_mrad",)
    assert "lens" in done.left_out[0]


def test_an_unknown_module_copies_what_is_set_and_takes_nothing(library, paste):
    strange = Node("strange", "of_another_version", {"gain": 2, "list": [1, {"a": None}]})
    text = copied_values(strange, None)
    assert json.loads(text)["values"] == {"gain": 2, "list": [1, {"a": None}]}
    with pytest.raises(NetworkError, match="strange is of an unknown module"):
        paste(network_of(strange), "strange", "strange")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "holds no values"),
        ("a shopping list", "holds no values"),
        ('{"format": "imagechain-nodes", "nodes": {}}', "holds no values"),
        ('{"format": "imagechain-values", "values": {}}', "holds no values"),
        ('{"format": "imagechain-values", "values": [1]}', "holds no values"),
        ('{"format": "imagechain-values", "values": {"a": 1}, "units": [1]}', "units"),
        ('{"format": "imagechain-values", "values": {"a": NaN}}', "NaN"),
        ('{"format": "imagechain-values"', "not JSON"),
    ],
)
def test_what_holds_no_values_is_refused_in_one_line(text, message, paste):
    with pytest.raises(NetworkError, match=message) as caught:
        paste(network_of(BLUR), "", "blur", text=text)
    assert "\n" not in str(caught.value)


def test_a_list_of_a_file_keeps_its_kind(library, paste):
    """The text has a list where the node has a tuple; both are the same in a file."""
    key, name = next(
        (key, parameter.name)
        for key, module in library.items()
        for parameter in declaration(module).parameters
        if parameter.kind == "numbers"
    )
    network = network_of(Node("one", key, {name: [0.25]}), Node("two", key))
    after = paste(network, "one", "two").operation.apply(network)
    assert plain(after.nodes["two"].params[name]) == [0.25]
    assert set_parameter("two", name, [0.25]).apply(network) == after
