"""Queries of rays and points, and their results."""
