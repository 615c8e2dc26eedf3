"""A library of a few modules."""


def library_of(modules):
    return {module.key: module for module in modules}
