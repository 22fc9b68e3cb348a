"""What is wrong with a scene."""


class SceneError(ValueError):
    """A scene that cannot be read; says where."""
