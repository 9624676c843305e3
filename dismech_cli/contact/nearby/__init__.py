"""What is near: candidates, what is left out along a body, how far things may move."""
