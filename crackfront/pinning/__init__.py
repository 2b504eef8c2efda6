"""The work of adhesion along the rays of the front, sampled where the front is.

On a ray the product radius * work of adhesion is cubic between samples, or linear as in the paper
(supplement, Sec. II). The solver asks for single samples and never for a whole polar array.
"""

from crackfront.pinning.fields import (
    Field,
    Interpolation,
    PolarField,
    TileField,
    first_radius,
    last_radius,
    n_angle,
    polar_field,
    tile_field,
)
from crackfront.pinning.pieces import blend, hull_until, peek_piece, polynomial, steepest_inside
from crackfront.pinning.rays import (
    front_adhesion,
    front_products,
    sampled_on_rays,
    segment_below,
    swept_adhesion,
)
from crackfront.pinning.samples import (
    SampleMemory,
    evaluate,
    fetch,
    is_cubic,
    make_memory,
    sample_count,
    sample_product,
    sample_radius,
    samples_ahead,
)

__all__ = [
    "Field",
    "Interpolation",
    "PolarField",
    "SampleMemory",
    "TileField",
    "blend",
    "evaluate",
    "fetch",
    "first_radius",
    "front_adhesion",
    "front_products",
    "hull_until",
    "is_cubic",
    "last_radius",
    "make_memory",
    "n_angle",
    "peek_piece",
    "polar_field",
    "polynomial",
    "sample_count",
    "sample_product",
    "sample_radius",
    "sampled_on_rays",
    "samples_ahead",
    "segment_below",
    "steepest_inside",
    "swept_adhesion",
    "tile_field",
]
