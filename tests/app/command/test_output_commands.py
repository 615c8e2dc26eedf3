"""Which picture `run` and `check` take for the output, and what they say where several may be."""

import pytest

LINE = (
    "this network ends in 2 pictures (pixels.image, noisy.image) and none is marked final: "
    "select the node whose picture is the output and press O, or give --final NODE.PORT"
)


@pytest.fixture
def two(small, write):
    small["nodes"] |= {
        "other": {"module": "test_scene", "params": {"width": 16, "height": 16}},
        "noisy": {"module": "poisson_noise"},
    }
    small["links"].append(["other.image", "noisy.image"])
    write(small)
    return small


def test_run_does_not_choose_among_two(two, works, tmp_path):
    done = works("run", "net.json", "--output-dir", "out", "--save", "noisy.image=noisy.npy")
    assert f"no final.png: {LINE}" in done.stdout.splitlines()
    assert "no total in mtf.csv: this network ends in 2 pictures" in done.stdout
    written = {path.name for path in (tmp_path / "out").iterdir()}
    assert written == {"mtf.csv", "readouts.json"}
    assert (tmp_path / "noisy.npy").is_file()


def test_final_on_the_command_line(two, imagechain, works, tmp_path):
    done = works("run", "net.json", "--final", "pixels.image", "--output-dir", "one")
    assert "total" not in done.stdout
    assert "total.mtf_x" in (tmp_path / "one" / "mtf.csv").read_text()
    done = works("run", "net.json", "--final", "noisy.image", "--output-dir", "other")
    told = "no total in mtf.csv: no Back Transform comes before the output, noisy.image"
    assert told in done.stdout.splitlines()
    assert "total.mtf_x" not in (tmp_path / "other" / "mtf.csv").read_text()
    shapes = [(tmp_path / name / "final.png").read_bytes()[16:24] for name in ("one", "other")]
    assert [int.from_bytes(s[:4]) for s in shapes] == [24, 16]  # columns, from the PNG's header
    assert imagechain("check", "net.json", "--final", "noisy.image").returncode == 0


@pytest.mark.parametrize(
    ("port", "told"),
    [
        ("noisy.imag", "noisy has no picture imag; did you mean image?"),
        ("init.context", "init has no picture context; its pictures: none"),
    ],
)
def test_a_wrong_final_is_one_line(two, fails, port, told):
    line = fails("run", "net.json", "--final", port)
    assert line.startswith(f"imagechain: --final {port}: ")
    assert told in line
