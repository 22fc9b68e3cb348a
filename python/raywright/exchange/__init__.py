"""What surfaces send each other, as numbers: view factors, radiosity, heat."""
