"""From a scene and a camera to a picture, with its error against its time."""
