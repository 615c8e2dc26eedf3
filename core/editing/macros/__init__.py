"""Operations on macros: grouping, ungrouping, what they show, and changes inside of them."""
