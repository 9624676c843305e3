"""The run file: one HDF5 file that ParaView opens directly and that holds the exact state."""
