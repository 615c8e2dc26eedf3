"""The rooms of the source: imports go downwards, no circle, no crowded folder, no name twice."""

from collections import Counter

from child_process import ROOT
from import_arrows import circles, file_arrows, folder_arrows, modules

MOST_FILES = 16


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


def test_no_crowded_folder():
    numbers = Counter(
        path.parent.relative_to(ROOT)
        for path in modules().values()
        if path.name not in ("__init__.py", "__main__.py")
    )
    assert not {str(folder): n for folder, n in numbers.items() if n > MOST_FILES}


def test_no_base_name_twice():
    files = [
        name for name, path in modules().items() if path.name not in ("__init__.py", "__main__.py")
    ]
    numbers = Counter(name.rpartition(".")[2] for name in files)
    assert not {
        name: [each for each in files if each.rpartition(".")[2] == name]
        for name, number in numbers.items()
        if number > 1
    }
