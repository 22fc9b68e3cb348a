"""OpenEXR files: pictures of many channels, read by every common method of compression and written by ZIP."""
