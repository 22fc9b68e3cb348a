"""Whole scenes from files, ready to be rendered."""
