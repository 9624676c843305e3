"""What looks at frames of contact, and shares no code with what makes them."""
