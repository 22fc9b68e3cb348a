"""Files and other libraries' objects, in and out."""
