"""A picture file through modules written as a list: spectra between Init & Trans and Back."""

import numpy as np

from core.modules.declaration import declaration
from node_bench import NodeBench
from nodes.library import standard_library

LIBRARY = standard_library()
WIRES = {"charge_eff_phase": ("phase",), "exit_pupil_mtf": ("magnitude", "phase")}


def fov_deg(size, interval_mrad):
    return float(np.degrees(size * interval_mrad / 1000))


def short_chain(folder, picture, modules, *, interval_mrad=1.0, init=(), precision="double"):
    """A bench and its last picture's port; nodes are named by their modules' keys.

    `modules` are (key, parameters); those with a magnitude or a phase come first, the others work
    on the picture. A pupil stands before the module it is for.
    """
    np.save(folder / "in.npy", picture)
    fov = {
        f"fov_{axis}_deg": fov_deg(size, interval_mrad)
        for axis, size in zip("yx", np.shape(picture), strict=True)
    }
    nodes = {
        "file": ("read_image", {"path": "in.npy", **fov}),
        "init": ("init_trans", dict(init)),
        "back": ("back_transform", {}),
    }
    links, wires, last = [("file.image", "init.image")], {}, "back"
    for key, params in modules:
        nodes[key] = (key, params)
        declared = declaration(LIBRARY[key])
        if declared.input("context"):
            links.append(("init.context", f"{key}.context"))
        if key == "exit_pupil_mtf":
            links.append(("exit_pupil.pupil", "exit_pupil_mtf.pupil"))
        if declared.input("image"):
            links.append((f"{last}.image", f"{key}.image"))
            last = key
        elif key != "exit_pupil":
            for wire in WIRES.get(key, ("magnitude",)):
                links.append((f"{wires.get(wire, 'init')}.{wire}", f"{key}.{wire}"))
                wires[wire] = key
    for wire in ("magnitude", "phase"):
        links.append((f"{wires.get(wire, 'init')}.{wire}", f"back.{wire}"))
    return NodeBench(LIBRARY, folder, nodes, links, precision=precision), f"{last}.image"
