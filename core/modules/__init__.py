"""What a module declares: parameters, ports, read-outs, warnings."""
