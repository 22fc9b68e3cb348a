"""What rays and points ask of a scene, and what comes back."""
