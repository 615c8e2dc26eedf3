"""Queries by owner: those that stay keep their number, and old answers are of no use."""

from app.editor.evaluation.evaluator import OwnedQueries
from app.editor.evaluation.queries import Answer


def answer(owner, generation):
    return Answer(generation, owner, "picture", None, None, 1)


def test_answers_of_use():
    queries = OwnedQueries()
    assert not queries.accept(answer("viewer", 7))
    queries.post("viewer", ["picture"], 3)
    assert [queries.accept(answer("viewer", number)) for number in (2, 3, 5, 5, 4, 6)] == [
        *(False, True, True, True, False, True)
    ]
    queries.drop("viewer")
    assert not queries.accept(answer("viewer", 9))


def test_an_owner_that_comes_again_begins_anew():
    queries = OwnedQueries()
    queries.post("viewer", ["picture"], 3)
    assert queries.accept(answer("viewer", 8))
    queries.drop("viewer")
    queries.post("viewer", ["picture"], 6)
    assert not queries.accept(answer("viewer", 5))
    assert queries.accept(answer("viewer", 6))
