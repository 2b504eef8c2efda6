"""The work of adhesion along the rays of the front, sampled where the front is.

On a ray the product radius * work of adhesion is linear between samples (supplement, Sec. II).
The solver asks for single samples and never for a whole polar array.
"""

from crackfront.pinning.fields import (
    Field,
    PolarField,
    TileField,
    first_radius,
    last_radius,
    n_angle,
    polar_field,
    tile_field,
)
from crackfront.pinning.rays import (
    front_adhesion,
    front_products,
    sampled_on_rays,
    segment_below,
    swept_adhesion,
)
from crackfront.pinning.samples import (
    SampleMemory,
    fetch,
    make_memory,
    peek,
    sample_count,
    sample_product,
    sample_radius,
)

__all__ = [
    "Field",
    "PolarField",
    "SampleMemory",
    "TileField",
    "fetch",
    "first_radius",
    "front_adhesion",
    "front_products",
    "last_radius",
    "make_memory",
    "n_angle",
    "peek",
    "polar_field",
    "sample_count",
    "sample_product",
    "sample_radius",
    "sampled_on_rays",
    "segment_below",
    "swept_adhesion",
    "tile_field",
]
