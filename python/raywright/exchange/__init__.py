"""Diffuse exchange between surfaces: view factors, radiosity, radiative heat transfer."""
