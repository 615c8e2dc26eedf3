"""The command line and its reports; no other layer knows this one."""
