"""The function of the library: arrays, tables, datasets, and arguments that cannot be used."""

import numpy as np
import pytest
import xarray as xr

from crackfront import measured_loop
from tests.measured.loops.made import MODULUS, RADIUS, W_RETR, in_contact, loop

_TOUCHING = np.repeat([0.0, 1e-5, 0.0], 20)
"""Contact radius of a loop with rows out of contact. (Units: m)"""

_LOST_IN_CONTACT = np.where(_TOUCHING > 0, np.nan, 0.0)


def test_arrays_and_their_table_are_the_same_loop(tmp_path):
    whole = loop(0)
    arrays = {"force": whole.force, "radius": whole.radius}
    path = tmp_path / "rig.csv"
    rows = zip(whole.force, whole.radius, strict=True)
    path.write_text("Force (N),Radius (m)\n" + "".join(f"{f},{a}\n" for f, a in rows))
    rig = {"radius": RADIUS, "contact_modulus": MODULUS}
    assert repr(measured_loop(arrays, **rig)) == repr(measured_loop(path, **rig))
    with pytest.raises(ValueError, match="speed is not a column of a loop"):
        measured_loop({"force": whole.force, "speed": whole.force}, **rig)


@pytest.mark.parametrize(
    ("columns", "sentence"),
    [
        ({"force": np.zeros(50), "displacement": np.linspace(0, 1e-6, 50)}, "no row is in contact"),
        ({"force": np.zeros(50), "radius": np.zeros(50)}, "no row is in contact"),
        ({"force": np.full(50, np.nan), "radius": np.ones(50)}, "force lacks finite values"),
        ({"force": np.zeros(50)}, "needs two of"),
        ({"force": np.zeros(50), "radius": np.ones(49)}, "not of one length"),
        (
            {"force": np.ones(50), "radius": np.linspace(-1e-4, 1e-4, 50)},
            "radius.* must not be negative",
        ),
        ({"force": _LOST_IN_CONTACT, "radius": _TOUCHING}, "force lacks values in contact"),
        (
            {"displacement": _LOST_IN_CONTACT, "radius": _TOUCHING},
            "displacement lacks values in contact",
        ),
    ],
)
def test_what_is_no_loop_is_refused(columns, sentence):
    with pytest.raises(ValueError, match=sentence):
        measured_loop(columns, radius=RADIUS, contact_modulus=MODULUS)


def test_masked_rows_are_left_out_and_texts_have_units():
    columns = in_contact(force_noise=0.0, radius_noise=0.0)
    spiked = np.ma.masked_array(columns["force"].copy(), np.arange(columns["force"].size) == 40)
    spiked.data[40] = 9999.0
    rig = {"force": spiked, "radius": columns["radius"]}
    result = measured_loop(rig, radius="1.25mm", contact_modulus=f"{MODULUS}Pa")
    assert result.w_retr.value == pytest.approx(W_RETR, rel=1e-9)
    labelled = xr.Dataset(
        {"force": ("t", 1e3 * columns["force"], {"units": "mN"}), "radius": ("t", rig["radius"])}
    )
    timed = labelled.assign(time=("t", np.arange(labelled.sizes["t"])))
    for dataset in (labelled, timed, dict(labelled)):
        assert measured_loop(dataset, radius=RADIUS).w_retr.value == pytest.approx(W_RETR, rel=1e-9)


def test_youngs_modulus_and_poissons_ratio_are_the_contact_modulus():
    columns = in_contact()
    works = [
        measured_loop(columns, radius=RADIUS, **modulus).w_retr.value
        for modulus in ({"contact_modulus": 0.7e6 / 0.91}, {"modulus": "0.7MPa", "poisson": 0.3})
    ]
    assert works[0] == works[1]


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"modulus": 0.7e6}, "modulus is 700000.0 and poisson is None; give both"),
        ({"poisson": 0.5}, "modulus is None and poisson is 0.5; give both"),
        ({"modulus": 0.7e6, "poisson": 0.6}, "poisson is 0.6"),
        ({"modulus": 0.7e6, "contact_modulus": 1e6}, "contact_modulus is .*; give the contact"),
        ({"window": "70um:120um"}, "window is '70um:120um'; it must be a list"),
        ({"window": (7e-5, 1e-4, 2e-4)}, "window is .* at most 2 items"),
        ({"window": ("70um", "1g")}, "a contact radius of window is '1g'"),
        ({"modulus_error": "1%"}, "modulus_error is '1%'; it must be a number"),
        ({"stiffness": "3kg"}, "not a unit of stiffness"),
    ],
)
def test_an_argument_that_cannot_be_used_is_refused(arguments, sentence):
    columns = in_contact()
    with pytest.raises((TypeError, ValueError), match=sentence):
        measured_loop(columns, radius=RADIUS, **arguments)
