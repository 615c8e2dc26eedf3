"""The command line and its reports; no other layer imports this one."""
