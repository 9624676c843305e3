"""What a user may say: one file per part of a scenario."""
