"""Synthetic scans, as the files of an instrument, including those in `examples/scans`.

They are AL3D files, the format of Alicona's focus-variation microscopes: a list of tags, a comment,
and single-precision heights in metres. Their comments say that they are synthetic.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from crackfront.core.arrays import Array
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.measured.options import ReadingOptions
from crackfront.measured.scan.reading import read_measurements
from crackfront.measured.spectrum.measured_surface import MeasuredSurface, measured_surface

SEED = 20240229
ROLL_OFF = 2.1e-6
"""Roll-off of nanodiamond, Sanner et al., Sci. Adv. (2024), Fig. 5. (Units: m)"""

HURST = 1.0
"""Hurst exponent of nanodiamond, from the same figure."""

PLATEAU = 8.4e-27
"""Density of nanodiamond below the roll-off, from the same figure. (Units: m^4)"""

MAGIC = b"AliconaImaging\x00\r\n"
COMMENT_BYTES = 256
END = b"\r\n"


@dataclass(frozen=True, slots=True)
class Scan:
    """A map to write: file without suffix, an even number of points a side, their distance in m."""

    name: str
    n_point: int
    pixel: float


SCANS = (
    Scan("nanodiamond-overview", n_point=144, pixel=0.3e-6),
    Scan("nanodiamond-detail", n_point=144, pixel=0.05e-6),
)


def scan_heights(scan: Scan, seed: np.random.SeedSequence) -> Array:
    """Heights of a scan, with the waves that its pixels resolve (Units: m)."""
    spectrum = SelfAffineSpectrum(2 * scan.pixel, ROLL_OFF, HURST, PLATEAU)
    side = 2 * scan.n_point * scan.pixel
    heights = gaussian_field(spectrum, 2 * scan.n_point, side, np.random.default_rng(seed))
    return heights[: scan.n_point, : scan.n_point]


def al3d(heights: Array, pixel: float | tuple[float, float], comment: str) -> bytes:
    """Content of an AL3D file of (n_x, n_y) heights, n_x even (Units: m).

    The distance of points is one number, or two where it differs along x and y. A comment has fewer
    than 255 characters of Latin-1.
    """
    columns, rows = heights.shape
    along_x, along_y = pixel if isinstance(pixel, tuple) else (pixel, pixel)
    tags = {
        "Type": "SurfaceData",
        "DirSpacer": "\\",
        "Rows": str(rows),
        "Cols": str(columns),
        "NumberOfPlanes": "0",
        "PixelSizeXMeter": f"{along_x:.10g}",
        "PixelSizeYMeter": f"{along_y:.10g}",
        "InvalidPixelValue": "NaN",
        "DepthImageOffset": "",
        "TextureImageOffset": "0",
    }
    head = len(MAGIC) + (2 + len(tags)) * len(_tag("", ""))
    tags["DepthImageOffset"] = str(head + COMMENT_BYTES)
    lines = [_tag("Version", "1"), _tag("TagCount", str(len(tags)))]
    lines += [_tag(key, value) for key, value in tags.items()]
    text = comment.encode("latin-1").ljust(COMMENT_BYTES - len(END), b"\x00") + END
    return MAGIC + b"".join(lines) + text + heights.T.astype("<f4").tobytes()


def _tag(key: str, value: str) -> bytes:
    """A line of the list of tags."""
    return key.encode("ascii").ljust(20, b"\x00") + value.encode("ascii").ljust(30, b"\x00") + END


def scanned(
    heights: Array,
    pixel: float | tuple[float, float],
    comment: str,
    tip_radius: float | None = None,
) -> MeasuredSurface:
    """Surface that is read from an AL3D file, as of :func:`al3d`, with a tip if one is named."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scan.al3d"
        path.write_bytes(al3d(heights, pixel, comment))
        options = ReadingOptions(tip_radius=tip_radius)
        return measured_surface(read_measurements([path], options))


def write_scans(folder: Path) -> None:
    """Write the synthetic scans of nanodiamond.

    Two maps of one surface, an overview and a detail, each cut from a larger periodic surface so
    that its edges do not fit together, as in a measurement.
    """
    for scan, seed in zip(SCANS, np.random.SeedSequence(SEED).spawn(len(SCANS)), strict=True):
        comment = (
            "SYNTHETIC, not a measurement: random self-affine surface with the published spectrum "
            f"of nanodiamond (H = {HURST:g}, roll-off {1e6 * ROLL_OFF:g} um, plateau "
            f"{PLATEAU:g} m^4), seed {SEED}"
        )
        content = al3d(scan_heights(scan, seed), scan.pixel, comment)
        (folder / f"{scan.name}.al3d").write_bytes(content)
