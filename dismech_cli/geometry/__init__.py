"""Pure functions of plain arithmetic on components, shared by all kernels."""
