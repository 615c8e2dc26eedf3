"""A picture file through modules written as a list: spectra between Init & Trans and Back."""

import numpy as np

from core.modules.declaration import declaration
from node_bench import NodeBench, fov_of
from nodes.library import standard_library

LIBRARY = standard_library()


def short_chain(folder, picture, modules, *, interval_mrad=1.0, init=(), precision="double"):
    """A bench and its last picture's port; nodes are named by their modules' keys.

    `modules` are (key, parameters); those with a magnitude or a phase come first, the others work
    on the picture. A pupil stands before the module it is for.
    """
    np.save(folder / "in.npy", picture)
    fov = fov_of(np.shape(picture), interval_mrad)
    nodes = {"file": ("read_image", {"path": "in.npy", **fov}), "init": ("init_trans", dict(init))}
    pictures = {}
    for key, params in modules:
        of_picture = declaration(LIBRARY[key]).input("image")
        (pictures if of_picture else nodes)[key] = (key, params)
    nodes |= {"back": ("back_transform", {}), **pictures}
    return NodeBench(folder, nodes, precision=precision), f"{list(nodes)[-1]}.image"
