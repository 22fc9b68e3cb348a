"""Other libraries' interfaces, on raywright's rays."""
