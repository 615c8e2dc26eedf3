"""What a person types for a number: arithmetic and units where it is more than one number."""

from __future__ import annotations

import re

from app.editor.number_text import number_of
from core.errors import ParameterError
from core.modules.parameters import Parameter
from core.network.expression_arithmetic import value_of
from core.network.expression_grammar import ExpressionError, parse_expression

_THOUSANDS = re.compile(r"(?<![\d.,])[1-9]\d{0,2},\d{3}(?![\d,.])")
_DECIMAL_COMMA = re.compile(r"(?<=\d),(?=\d)")
_ARITHMETIC = re.compile(r"[\d(]|\w\.\w")


def typed_number(text: str, parameter: Parameter) -> float | int | str | None:
    """The number a person typed, in the parameter's unit; the text where it is none.

    ``600 urad`` typed for mrad is 0.6, ``2*0.3`` is 0.6 in any unit. A comma is a decimal point
    except between the arguments of a function.

    Raises
    ------
    ParameterError
        For arithmetic that has no value, or a unit that does not fit; and as `number_of`.
    """
    number = number_of(text, parameter)
    if not isinstance(number, str) or not _ARITHMETIC.search(number):
        return number
    written = text.strip()
    if "(" not in written:
        thousands = _THOUSANDS.search(written)
        if thousands:
            whole, _, rest = thousands[0].partition(",")
            clear = f"either {whole}{rest} or {whole}.{rest}"
            raise ParameterError(parameter.name, text, clear)
        written = _DECIMAL_COMMA.sub(".", written)
    try:
        return value_of(parse_expression(written), unit=parameter.param.unit)
    except ExpressionError as error:
        raise ParameterError(parameter.name, text, error.message) from None
