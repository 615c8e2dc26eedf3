"""What holds for every test: helpers that explain themselves, and an end to every wait."""

import ctypes
import faulthandler
import gc
import os
import resource
import sys
from functools import cache
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

# As the command has it, before anything imports numpy: BLAS threads that wait for a busy processor
# take several times the time of what they share.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

ROOT = Path(__file__).parents[1]
SUPPORT = ROOT / "tests" / "support"
# No test takes a hundredth of it. Those of the helpers are shorter and say what was waited for.
LONGEST_S = 1200
# Between two collections of what refers to itself, such as windows with the pictures they show:
# Python counts objects, not their size.
GROWTH_BYTES = 200 * 2**20
AFTER_COLLECTION = pytest.StashKey[int]()
LEFT_OUT = pytest.StashKey[int]()

# No example fails for taking long.
settings.register_profile(
    "thorough", deadline=None, suppress_health_check=[HealthCheck.too_slow], max_examples=100
)
settings.register_profile("any machine", settings.get_profile("thorough"), max_examples=25)
settings.load_profile("any machine")

pytest.register_assert_rewrite(*sorted(path.stem for path in SUPPORT.glob("*.py")))


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers():
    """Three workers for two cores: a test of the window waits for its display a third of the time.

    None needs more than 1.5 GB.
    """
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return cores + cores // 2


def pytest_addoption(parser):
    parser.addoption("--thorough", action="store_true", help="run every variation of every check")


def pytest_configure(config):
    from child_process import let_children_be_stopped

    if config.option.thorough:
        settings.load_profile("thorough")
    let_children_be_stopped()
    if not hasattr(config, "workerinput"):
        bring_stub_up_to_date()


def bring_stub_up_to_date():
    """`imagechain/modules.pyi` says what the modules declare; nobody need think of it."""
    stub = ROOT / "imagechain" / "modules.pyi"
    declared = max(path.stat().st_mtime for path in (ROOT / "nodes").rglob("*.py"))
    if not stub.exists() or stub.stat().st_mtime < declared:
        from imagechain.parts.module_stub import stub_text
        from nodes.library import OURS, our_module

        stub.write_text(stub_text({key: our_module(key) for key in OURS}), encoding="utf-8")


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Look for no garbage while thousands of tests are collected, nor ever among them.

    They stay until the end, and many tests of the window look for garbage themselves.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()
        gc.freeze()


@pytest.fixture(autouse=True, scope="session")
def _own_state(tmp_path_factory):
    """What runs remember goes into a folder of the tests', also of the processes they start."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))
        yield


@pytest.fixture(scope="session")
def of_all_workers(tmp_path_factory):
    """A folder that the processes of one run of the tests share."""
    base = tmp_path_factory.getbasetemp()
    return base.parent if os.environ.get("PYTEST_XDIST_WORKER") else base


@pytest.fixture(scope="session")
def shipped_report(of_all_workers):
    """The reports of a network by its name, as it is shipped."""
    from shipped_reports import reports_of

    folder = of_all_workers / "shipped_reports"
    folder.mkdir(exist_ok=True)
    return cache(lambda network: reports_of(network, folder))


@pytest.fixture(autouse=True, scope="session")
def _compiled_once(of_all_workers):
    """Where bytecode is not written, the processes of the tests keep theirs in a folder of ours.

    Without, each of hundreds compiles anew all that it imports: half the time of a short one.
    """
    with pytest.MonkeyPatch.context() as patch:
        if sys.dont_write_bytecode:
            patch.setenv("PYTHONPYCACHEPREFIX", str(of_all_workers / "bytecode"))
            patch.delenv("PYTHONDONTWRITEBYTECODE", raising=False)
        yield


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item):
    """End the process, saying where it stands, if a test waits for ever; give memory back."""
    faulthandler.dump_traceback_later(LONGEST_S, exit=True, file=sys.__stderr__)
    try:
        return (yield)
    finally:
        faulthandler.cancel_dump_traceback_later()
        before = item.config.stash.get(AFTER_COLLECTION, 0)
        if resident_bytes() > before + GROWTH_BYTES:
            gc.collect()
            give_free_memory_back()
            item.config.stash[AFTER_COLLECTION] = resident_bytes()


def pytest_ignore_collect(collection_path, config):
    """Read only the files that are wanted: to read all of them takes longer than the quick ones."""
    from quick_tests import is_quick

    wanted = config.option.markexpr != "quick" or not collection_path.match("test_*.py")
    return None if wanted or is_quick(collection_path) else True


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config, items):
    from quick_tests import is_quick
    from thorough import parted

    for item in items:
        if is_quick(item.path):
            item.add_marker("quick")
    if not config.option.thorough and not any("::" in word for word in config.args):
        items[:], left_out = parted(items)
        config.hook.pytest_deselected(items=left_out)
        config.stash[LEFT_OUT] = len(left_out)
        if hasattr(config, "workeroutput"):  # of pytest-xdist; all workers collect the same
            config.workeroutput["left_out"] = len(left_out)


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node, error):
    worker = getattr(node, "workeroutput", {})
    node.config.stash[LEFT_OUT] = max(node.config.stash.get(LEFT_OUT, 0), worker.get("left_out", 0))


def pytest_terminal_summary(terminalreporter, config):
    if config.stash.get(LEFT_OUT, 0):
        count = config.stash[LEFT_OUT]
        terminalreporter.write_line(f"{count} variations left out: --thorough runs them too")


def give_free_memory_back():
    """The C library keeps hundreds of MiB of what thousands of tests have freed."""
    libc = ctypes.CDLL(None) if os.name == "posix" else None
    if hasattr(libc, "malloc_trim"):
        libc.malloc_trim(0)


def resident_bytes():
    """Memory that this process has in use."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * resource.getpagesize()
