"""The error of a mesh that cannot be taken."""


class MeshError(ValueError):
    """A mesh that cannot become a deck, and what is expected."""
