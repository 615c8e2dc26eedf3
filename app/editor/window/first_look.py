"""Which pictures to show of a network that has just been opened."""

from __future__ import annotations

from app.chain import final_image, source_images
from core.engine import Plan
from core.errors import ImagechainError


def first_ports(plan: Plan) -> tuple[str, ...]:
    """The final picture and the input picture it is to be compared with; as many as there are."""
    try:
        final = final_image(plan)
    except ImagechainError:
        final = None
    sources = [port for port in source_images(plan) if port != final]
    return tuple(port for port in (final, *sources[:1]) if port is not None)
