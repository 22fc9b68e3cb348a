"""Errors of scenes."""


class PbrtError(ValueError):
    """A scene that cannot be read; says where."""
