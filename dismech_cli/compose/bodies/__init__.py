"""Bodies of the scenario as arrays: meshes, sections, joints, masses, selections."""
