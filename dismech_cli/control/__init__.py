"""Time laws that drive natural strains."""
