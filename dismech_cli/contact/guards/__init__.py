"""What keeps a distance, by a barrier and by stopping every motion short of it."""
