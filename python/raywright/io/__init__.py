"""Files of pixels, and quiet for the libraries that read files."""
