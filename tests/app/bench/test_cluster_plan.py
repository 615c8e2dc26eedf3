"""Plans by hand: 2¹⁸ samples a scene, 100 ns each."""

import pytest

from app.bench.scale.cluster_plan import Rates, frame_plan, scenes_plan

RATES = Rates(core_ns=100.0, written_bytes=25.0, scratch_bytes=12.0)


def test_scenes():
    plan = scenes_plan(RATES, scenes=10**6, side=512, cores=64)
    assert plan.core_hours == pytest.approx(262144e6 * 100e-9 / 3600)  # 7.28
    assert plan.hours == pytest.approx(plan.core_hours / 64)
    assert plan.disk_bytes == 2 * 4 * 262144e6
    assert plan.memory_bytes == 64 * 8 * 2**20  # eight pictures of 1 MiB on every core


def test_a_frame_waits_for_computing_or_for_the_disk():
    slow = frame_plan(RATES, side=10**5, cores=2, disk_bytes_per_s=1e9)
    assert (slow.limit, slow.hours) == ("computing", pytest.approx(1e10 * 100e-9 / 2 / 3600))
    fast = frame_plan(RATES, side=10**5, cores=16, disk_bytes_per_s=1e9)
    assert (fast.limit, fast.hours) == ("the disk", pytest.approx(1e10 * 25 / 1e9 / 3600))
    assert fast.row()["disk_GB"] == pytest.approx(10 * (8 + 12))
