"""Diffuse exchange between surfaces: view factors, radiosity, heat."""
