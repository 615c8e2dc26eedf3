"""What a picture has gone through: its transfer functions and noises, read off its recipe."""

from nodes.analysis.lineage.line_transfer import ImageTransfer, transfer_of
from nodes.analysis.lineage.noise_lineage import ImageNoise, NoiseOf, NoiseTerm, noise_free

__all__ = ["ImageNoise", "ImageTransfer", "NoiseOf", "NoiseTerm", "noise_free", "transfer_of"]
