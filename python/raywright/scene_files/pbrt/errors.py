"""What is wrong with a scene."""


class PbrtError(ValueError):
    """A scene that cannot be read; says where."""
