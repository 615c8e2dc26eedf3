"""The cached declarations are those of the files, whatever became of the cache."""

import json
import pickle
import sys

import pytest

from app.library_index import declarations
from app.user_folders import FOLDERS
from child_process import run_program
from core.modules.declaration import declaration
from nodes.library import OURS, standard_library

LIST = """
import json, sys
from app.library_index import declarations
from nodes.library import OURS, standard_library
found = declarations(standard_library())
files = [name for name in sys.modules if name.removeprefix("nodes.") in OURS.values()]
print(json.dumps([files, [repr(one) for one in found.values()]]))
"""


@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return FOLDERS.user_cache_path


@pytest.fixture(scope="module")
def derived():
    return {key: declaration(module) for key, module in standard_library().items()}


def test_a_second_process_loads_no_module_to_list_them_all(cache, derived):
    first, second = (json.loads(run_program(LIST).stdout) for _ in range(2))
    assert len(first[0]) == len({place.partition(":")[0] for place in OURS.values()})
    assert second[0] == []
    assert first[1] == second[1] == [repr(one) for one in derived.values()]
    assert declarations(standard_library()) == derived


def test_what_was_kept_of_other_files_is_not_believed(cache, derived):
    declarations(standard_library())
    (file,) = cache.iterdir()
    (python, files), kept = pickle.loads(file.read_bytes())
    wrong = dict.fromkeys(kept, kept["camera"])
    for stamp in [("another Python", files), (python, files[1:]), (python, [])]:
        file.write_bytes(pickle.dumps((stamp, wrong)))
        assert declarations(standard_library()) == derived
        assert pickle.loads(file.read_bytes())[1] == kept
    path, changed_ns, size = files[0]
    for other in [(path, changed_ns + 1, size), (path, changed_ns, size + 1)]:
        file.write_bytes(pickle.dumps(((python, [other, *files[1:]]), wrong)))
        assert declarations(standard_library()) == derived


@pytest.mark.skipif(sys.platform == "win32", reason="a folder is no file there either")
def test_without_a_place_for_it_they_are_derived(tmp_path, monkeypatch, derived):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    (tmp_path / "file").write_text("")
    assert declarations(standard_library()) == derived
    assert declarations({"camera": standard_library()["camera"]}) == {"camera": derived["camera"]}
