"""A camera's digital numbers in integer files: as they are, not stretched."""

import numpy as np

from nodes.files.formats import read_info, read_pixels

CAMERA = {
    "integration_time_s": 1e-4, "read_noise_e": 500.0, "full_well_e": 3e7, "bits": 12,
    "bad_pixel_percent": 1.0,
}  # fmt: skip


def test_a_twelve_bit_tiff_holds_0_to_4095(works, small, write, tmp_path):
    small["nodes"]["init"]["params"] |= {"detector_x_um": 30.0, "detector_y_um": 30.0}
    small["nodes"]["init"]["params"] |= {"f_number": 2.0, "platform": "array"}
    small["nodes"]["camera"] = {"module": "focal_plane", "params": CAMERA}
    small["nodes"]["file"] = {"module": "write_image", "params": {"path": "written.tif"}}
    small["links"] += [
        ["init.context", "camera.context"],
        ["back.image", "camera.image"],
        ["camera.image", "file.image"],
    ]
    works(
        "run", write(small), "--save", "camera.image=n.npy", "--save", "camera.image=saved.tif",
        "--save", "camera.saturated=s.npy", "--save", "camera.table=t.csv",
    )  # fmt: skip
    numbers = np.load(tmp_path / "n.npy")
    assert (numbers.min(), numbers.max()) == (0.0, 4095.0)  # a dead pixel, and a hot one
    assert len(np.unique(numbers)) > 50
    for name in ("saved.tif", "written.tif"):
        assert read_info(tmp_path / name).dtype == "uint16"
        np.testing.assert_array_equal(read_pixels(tmp_path / name), numbers)
    marked = np.load(tmp_path / "s.npy")
    assert marked.sum() == (numbers == 4095).sum()
    assert f"saturated_pixels,{int(marked.sum())}" in (tmp_path / "t.csv").read_text()
