"""Networks to be drawn and dragged about."""

from core.network.network import Link, Network, Node


def chain_and_free_blur():
    """A short chain, and a blur that lies free."""
    nodes = {
        "scene": Node("scene", "test_scene"),
        "init": Node("init", "init_trans"),
        "back": Node("back", "back_transform"),
        "blur": Node("blur", "jitter_mtf"),
    }
    links = (
        Link.between("scene.image", "init.image"),
        Link.between("init.magnitude", "back.magnitude"),
        Link.between("init.phase", "back.phase"),
    )
    layout = {"scene": (0, 0), "init": (240, 0), "back": (720, 0), "blur": (240, 260)}
    return Network(nodes=nodes, links=links, layout=layout)


def long_chain(nodes=100):
    """A scene, its transform, and blurs in rows of ten that all take the context."""
    made = {"scene": Node("scene", "test_scene"), "init": Node("init", "init_trans")}
    links = [Link("scene", "image", "init", "image")]
    before = "init"
    for number in range(nodes - 2):
        name = f"jitter_{number}"
        made[name] = Node(name, "jitter_mtf")
        links.append(Link("init", "context", name, "context"))
        links.append(Link(before, "magnitude", name, "magnitude"))
        before = name
    layout = {name: (240.0 * (n % 10), 160.0 * (n // 10)) for n, name in enumerate(made)}
    return Network(nodes=made, links=tuple(links), layout=layout)
