"""What is read from accepted states."""
