"""Queries by owner: those that stay keep their number, and old answers are of no use."""

from app.editor.evaluation.evaluator import OwnedQueries
from app.editor.evaluation.queries import Answer


def answer(owner, generation):
    return Answer(generation, owner, "picture", None, None, 1)


def numbers(queries):
    return {(request.owner, request.query): request.number for request in queries.all()}


def test_a_query_that_stays_keeps_its_number():
    queries = OwnedQueries()
    assert queries.post("viewer", ["picture", "curve"], 1)
    assert queries.post("panel", ["picture"], 1)
    before = numbers(queries)
    assert len(set(before.values())) == 3
    assert not queries.post("viewer", ["picture", "curve"], 2)
    assert queries.post("viewer", ["curve", "table"], 2)
    after = numbers(queries)
    assert set(after) == {("viewer", "curve"), ("viewer", "table"), ("panel", "picture")}
    assert after["viewer", "curve"] == before["viewer", "curve"]
    assert after["viewer", "table"] not in before.values()


def test_a_query_dropped_and_posted_again_has_another_number():
    queries = OwnedQueries()
    queries.post("viewer", ["picture"], 1)
    (before,) = queries.all()
    queries.drop("viewer")
    assert queries.all() == ()
    queries.post("viewer", ["picture"], 2)
    (after,) = queries.all()
    assert after.number != before.number


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
