"""From what is on a wire to 8-bit samples, facts and texts, without widgets."""
