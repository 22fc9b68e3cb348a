"""Errors of scenes."""


class SceneError(ValueError):
    """A scene that cannot be read; says where."""
