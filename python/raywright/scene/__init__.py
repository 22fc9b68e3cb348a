"""Scenes: shapes and lights, compiled for rays."""
