"""Many sessions, compared: sweeps, studies, gradients, calibrations and reports of runs."""
