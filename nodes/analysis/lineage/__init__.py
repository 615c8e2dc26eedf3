"""What a picture has gone through: its transfer functions and noises, read off its recipe."""

from nodes.analysis.lineage.noise_free import noise_free
from nodes.analysis.lineage.noise_lineage import ImageNoise, NoiseOf, NoiseTerm
from nodes.analysis.lineage.transfer_lineage import ImageTransfer, transfer_of

__all__ = [
    "ImageNoise",
    "ImageTransfer",
    "NoiseOf",
    "NoiseTerm",
    "noise_free",
    "transfer_of",
]
