"""What can be hit and what shines, put together and ready for rays."""
