"""True values without the measured code, and the chain as a plain program has it."""
