"""What surfaces send each other, as numbers."""
