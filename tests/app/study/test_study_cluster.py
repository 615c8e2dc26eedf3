"""A study by real worker processes: the same rows, and what becomes of a worker that dies."""

import logging

import distributed
import pytest

from child_process import PATIENCE_S

WORDS = ["--vary=blur.sigma_x_mrad=0:1:8", "--vary=electronics.d_star=1e10:1e12:5:log"]
WORDS += ["--figure=total.mtf_nyquist_x", "--figure=electronics.snr"]
# What Dask leaves to the collector is not ours.
pytestmark = pytest.mark.filterwarnings("ignore:.*:ResourceWarning")


@pytest.fixture(scope="module")
def cluster():
    """Two processes, begun once."""
    import dask

    settings = {"distributed.scheduler.allowed-failures": 0}
    logging_of = {"logging": {"distributed": "critical", "asyncio": "critical"}}
    with (
        dask.config.set({**settings, **logging_of}),
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True,
            dashboard_address="127.0.0.1:0", scheduler_kwargs={"dashboard": False}, memory_limit=0,
            silence_logs=logging.CRITICAL,
        ) as made,
    ):  # fmt: skip
        yield made


@pytest.fixture
def study(imagechain, sensor, cluster, monkeypatch):
    # On a busy machine a worker that has ended begins again when it can.
    monkeypatch.setattr("app.study.worker_processes._WITHOUT_S", PATIENCE_S)

    def run(*words, alone=False):
        where = ["--jobs=1"] if alone else ["--scheduler", cluster.scheduler_address]
        return imagechain("study", sensor, *WORDS, *where, *words)

    return run


def test_the_same_rows_as_of_one_process(study, rows_of, tmp_path):
    alone = study("--output=a.csv", alone=True)
    several = study("--output=b.csv", "--save=back.image=out/{point}.npy")
    assert (alone.returncode, several.returncode) == (0, 0), several.stderr
    assert rows_of("a.csv") == rows_of("b.csv")
    assert len(list((tmp_path / "out").iterdir())) == 40


def test_a_point_that_ends_its_workers_is_a_row_and_costs_no_other(study, rows_of, monkeypatch):
    """The worker is killed in the middle, with all that it had been given."""

    def deadly(setting, key, tasks, share):
        import os

        if any(place == 11 for place, _, _ in tasks):
            os._exit(1)
        from app.study.worker_processes import rows_of_batch

        return rows_of_batch(setting, key, tasks, share)

    monkeypatch.setattr("app.study.worker_processes.rows_of_batch", deadly)
    study("--output=a.csv", alone=True)
    done = study("--output=b.csv")
    assert done.returncode == 2
    assert done.stderr == (
        "imagechain: 1 of 40 points failed (see the column error in b.csv); the first is point 12: "
        "the workers computing this point stopped repeatedly\n"
    )
    expected, rows = rows_of("a.csv"), rows_of("b.csv")
    assert rows[11]["error"]
    del expected[11], rows[11]
    assert rows == expected
