"""Diffuse exchange between surfaces: view factors."""
