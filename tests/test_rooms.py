"""The rooms of the source: imports go downwards, without a circle."""

from import_arrows import circles, file_arrows, folder_arrows


def test_circles_are_seen():
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"a", "d"}, "d": {"d"}, "e": {"a"}}) == [
        ["a", "b", "c"]
    ]
    assert circles({"a": {"b", "c"}, "b": {"d"}, "c": {"d"}, "d": ()}) == []
    assert circles({"a": {"b"}, "b": {"a", "c"}, "c": {"d"}, "d": {"c"}}) == [
        ["c", "d"],
        ["a", "b"],
    ]


def test_no_circle_of_files():
    arrows = file_arrows()
    wrong = [
        f"{name} → {other}"
        for circle in circles(arrows)
        for name in circle
        for other in sorted(arrows[name] & set(circle))
    ]
    assert not wrong


def test_folders_import_from_below_only():
    arrows = folder_arrows()
    wrong = [
        example
        for circle in circles(arrows)
        for name in circle
        for other, example in arrows[name].items()
        if other in circle
    ]
    assert not wrong
