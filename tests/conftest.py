"""Here so that the folders below can import the helpers of this one."""
