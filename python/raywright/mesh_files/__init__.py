"""Meshes and their looks from files and from trimesh's objects."""
