"""Perimeters of a contact from the frames of a video, as in the paper's Methods."""

from __future__ import annotations

from types import ModuleType
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field, SkipValidation
from scipy.ndimage import gaussian_filter

from crackfront.core.arrays import Array
from crackfront.measured.optional_libraries import MissingExtraError
from crackfront.validation import Positive, WholeNumber, checked_call

_FEWEST_POINTS = 4
"""Points of a closed contour; the last one repeats the first."""


@checked_call
def contact_perimeters(
    images: SkipValidation[ArrayLike],
    pixel: Positive,
    *,
    reference: WholeNumber | None = None,
    level: Annotated[float, Field(lt=0)] | None = None,
    variance: Annotated[float, Field(ge=0)] = 2.0,
) -> list[Array]:
    r"""Perimeters of a contact that appears bright in the frames of a video.

    As in the paper's Methods, the frame at maximum penetration is subtracted from each frame, the
    difference is smoothed by a Gaussian filter, and the perimeter is a contour of fixed grey level:
    between the contact, which is equally bright in both frames, and the ring that is not yet in
    contact. The largest closed contour of a contact counts; islands of noise do not. Overlay the
    perimeters on main Fig. 5b with ``axes.plot(*perimeter.T)``.

    Parameters
    ----------
    images : (n_frame, n_row, n_column) array
        Grey levels of two frames or more.
    pixel : float
        Side of a pixel. (Units: length)
    reference : int, optional
        Frame at maximum penetration, by default the brightest one.
    level : float, optional
        Grey level of the contour, below zero, since what is not yet in contact is darker than in
        the reference. By default half of the difference between the grey
        levels around and inside the contact of the reference. (Units: grey level)
    variance : float, optional
        Variance of the Gaussian filter; 0 does not smooth. (Units: pixel**2)

    Returns
    -------
    list of (n_point, 2) array
        A closed curve of each frame, in the order of the frames: x to the right and y upwards, from
        the centre of the contact of the reference. It is empty in the reference and wherever the
        contact has reached the edge of its contact. (Units: length, as the pixel)

    Raises
    ------
    ValueError
        If there are less than two frames, if a grey level is not finite, if the reference is not a
        frame or of one grey level, if the pixel is not positive, if the variance is negative or the
        level not, or if scikit-image (the extra `video`) is not installed.

    References
    ----------
    .. [1] Sanner et al., Sci. Adv. (2024), Methods, Extraction of contact line from video.

    Examples
    --------
    >>> import numpy as np
    >>> import crackfront as cf
    >>> row, column = np.mgrid[:100, :100] - 50
    >>> radii = 20, 30, 40
    >>> images = [np.where(np.hypot(row, column) < radius, 200.0, 50.0) for radius in radii]
    >>> first, second, last = cf.contact_perimeters(images, pixel=0.5)
    >>> print(f"{np.hypot(*first.T).mean():.1f} {np.hypot(*second.T).mean():.1f}", len(last))
    9.9 14.9 0
    """
    frames, index = _frames(images), reference
    if index is None:
        index = int(np.argmax(frames.mean(axis=(1, 2))))
    elif not 0 <= index < len(frames):
        raise ValueError(f"reference is {index}; it must be a frame, 0 to {len(frames) - 1}")
    skimage = _skimage()
    in_contact, contrast = _contact(frames[index], skimage)
    if level is None:
        level = -contrast / 2
    centre = np.argwhere(in_contact).mean(axis=0)
    perimeters = []
    for frame in frames:
        difference = gaussian_filter(frame - frames[index], np.sqrt(variance), mode="nearest")
        row, column = (_largest_island(difference, level, skimage) - centre).T
        perimeters.append(pixel * np.column_stack([column, -row]))
    return perimeters


def _frames(images: ArrayLike) -> Array:
    """Frames of finite grey levels, two or more."""
    frames = np.asarray(images, dtype=float)
    if frames.ndim != 3 or len(frames) < 2:
        raise ValueError(
            f"images have the shape {frames.shape}; give two frames or more as "
            "(frame, row, column), of one grey level a pixel"
        )
    if not np.all(np.isfinite(frames)):
        frame = int(np.argwhere(~np.isfinite(frames))[0, 0])
        raise ValueError(f"frame {frame} has grey levels that are not finite; replace them")
    return frames


def _contact(reference: Array, skimage: ModuleType) -> tuple[Array, float]:
    """Pixels in contact in the reference, and how much brighter they are than the others."""
    if np.ptp(reference) == 0:
        raise ValueError(
            f"the reference has the grey level {reference[0, 0]:g} everywhere; choose a frame that "
            "shows the contact and what is around it"
        )
    in_contact = reference > skimage.filters.threshold_otsu(reference)
    return in_contact, float(reference[in_contact].mean() - reference[~in_contact].mean())


def _largest_island(difference: Array, level: float, skimage: ModuleType) -> Array:
    """Closed contour of the largest region above a level, (n_point, 2) rows and columns.

    It is empty without a contour, as where the ring of what is not yet in contact is open.
    """
    largest, most = np.empty((0, 2)), 0.0
    for contour in skimage.measure.find_contours(difference, level, positive_orientation="high"):
        if len(contour) < _FEWEST_POINTS or np.any(contour[0] != contour[-1]):
            continue
        row, column = contour.T
        # Contours wind in this sense around what is higher.
        area = float(np.sum(column[1:] * row[:-1] - column[:-1] * row[1:]) / 2)
        if area > most:
            largest, most = contour, area
    return largest


def _skimage() -> ModuleType:
    """The library scikit-image; an error says how it is installed."""
    try:
        import skimage.filters
        import skimage.measure
    except ModuleNotFoundError as error:
        raise MissingExtraError("perimeters", error, "video") from error
    return skimage
