"""What a user reads says it plainly: turns of phrase that never come back."""

import re

import pytest

from user_texts import Text, sentences, user_texts

NEVER = (
    r"\bis to be had\b|\bare to be had\b|\bto be had\b",
    r"\bgone on with\b|\bgoes on with\b|\bgo on with\b",
    r"\bthose of those\b|\bthat of that\b|\bof those of\b",
    r"\bas it is wanted\b|\bas is wanted\b|\bis as wanted\b",
    r"\bstands? in the\b|\bstands? beside\b|\bstand in for\b",
    r"\btold by\b|\bis told\b|\bare told\b",
    r"\beach has of\b|\bhas of its?\b|\bhas it of\b|\bhas of the\b",
    r"\bwarnings? (is|are) due\b|\b(is|are) due\b",
    r"\bputs? .{0,40} to the same work\b",
    r"\bthat come along\b|\bcomes along\b",
    r"\bparts the noise\b",
    r"\bin the room that it has\b",
    r"\bis one word too many\b|\btoo many words\b",
    r"\bwhat of it\b|\bof what there (is|are)\b|\bthere are of\b",
    r"\bat hand\b",
    r"\bis asked\b|\bare asked\b|\bis asked for\b",
    r"\bsuch as ha(s|ve)\b|\bsuch as (is|are)\b",
    r"^Of (a|an|the|such|this|these|each|checks|pictures)\b",
    r"\bas (it|they) (is|are) there\b",
    r"\bhalf (detect|recognize|identify|succeed)\b",
    r"[a-z] (across|along)(?=[.,;:)]|$)",  # across what?
    r"\bsame bits\b|\bbit for bit\b",
    r"\bwhich is no\b",
)


@pytest.fixture(scope="module")
def texts():
    return sentences(user_texts())


def test_the_list_has_every_kind_and_room(texts):
    assert {text.kind for text in texts} == {"message", "help", "window", "docstring", "page"}
    rooms = {text.place.split("/")[0] for text in texts}
    assert {"core", "nodes", "app", "imagechain", "networks"} <= rooms
    places = {text.place.rpartition(":")[0] for text in texts}
    assert {"README.md", "app/command/run_commands.py", "nodes/optics/camera.py"} <= places
    assert len(texts) > 3000


def test_turns_of_phrase_that_never_come_back(texts):
    never = re.compile("|".join(f"(?:{phrase})" for phrase in NEVER))
    found = [text for text in texts if never.search(text.words)]
    assert not found, "\n".join(f"{text.place}: {text.words}" for text in found)


def test_sentences_are_cut_where_they_end():
    text = Text("x.py:1", "help", "The first one ends here. The second is longer: it goes on.")
    assert [one.words for one in sentences([text])] == [
        "The first one ends here.",
        "The second is longer: it goes on.",
    ]
