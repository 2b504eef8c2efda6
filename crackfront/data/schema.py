"""Names, units and meanings of all dimensions and variables, stated once."""

from __future__ import annotations

from crackfront.core.records import ADHESION, ENERGY, FORCE, LATERAL, VERTICAL, Variable

STEP, ANGLE = "step", "angle"
SPECTRUM, AMPLITUDE, REALISATION = "spectrum", "amplitude", "realisation"

_step, _front = (STEP,), (STEP, ANGLE)
CURVES = (
    Variable("penetration", _step, VERTICAL, "rigid body penetration"),
    Variable("direction", _step, "1", "+1 in approach, -1 in retraction"),
    Variable("mean_radius", _step, LATERAL, "mean radius of the front"),
    Variable("min_radius", _step, LATERAL, "smallest radius of the front"),
    Variable("max_radius", _step, LATERAL, "largest radius of the front"),
    Variable("rms_radius", _step, LATERAL, "rms deviation of the radius from its mean"),
    Variable("force", _step, FORCE, "normal force, positive where it pushes"),
    Variable("contact_area", _step, f"({LATERAL})^2", "area within the front"),
    Variable("apparent_work_of_adhesion", _step, ADHESION, "mean of a G over mean of a"),
    Variable("least_travel", _step, LATERAL, "smallest way of a site since its branch began"),
    Variable("iterations", _step, "1", "sweeps of the solver"),
    Variable("updates", _step, "1", "updates of single sites by the solver"),
    Variable("residual", _step, ADHESION, "largest force along the motion, per front length"),
)
"""Variables of every cycle; each is a field of `CycleRecord`."""

DISSIPATED = Variable("dissipated_energy", _step, ENERGY, "energy lost in the jumps of a load step")
RADIUS = Variable("radius", _front, LATERAL, "front")
LAST_FRONT = Variable("last_front", (ANGLE,), LATERAL, "front of the last state")
TURNING_FRONT = Variable("turning_front", (ANGLE,), LATERAL, "front at which its branch began")
ANGLES = Variable(ANGLE, (ANGLE,), "rad", "angle of a site of the front")

COSTS = (
    Variable("e_el", (), ADHESION, "energy of full conformity measured on the tile"),
    Variable("w_rms", (), ADHESION, "rms of the local work of adhesion measured on the tile"),
    Variable("seconds", (), "s", "wall time of synthesis and cycle"),
    Variable("cpu_seconds", (), "s", "processor time of synthesis and cycle"),
    Variable(
        "peak_memory",
        (),
        "byte",
        "high-water mark of the process when the simulation ended, earlier ones included",
    ),
)
"""Variables that a simulation of a sweep has beside its curves."""

_spectrum, _shape = (SPECTRUM,), (SPECTRUM, AMPLITUDE)
_cell = (SPECTRUM, AMPLITUDE, REALISATION)
COORDINATES = (
    Variable(SPECTRUM, _spectrum, "1", "name of the spectrum"),
    Variable("short_cutoff", _spectrum, LATERAL, "shortest wavelength lambda_s"),
    Variable("roll_off", _spectrum, LATERAL, "roll-off wavelength lambda_r"),
    Variable("hurst", _spectrum, "1", "Hurst exponent, without effect on a flat spectrum"),
    Variable("correlation_length", _spectrum, LATERAL, "wavelength of the mean wavevector of w"),
    Variable("n_angle", _shape, "1", "sites of the front"),
    Variable("sample_spacing", _shape, LATERAL, "distance of samples along a ray"),
    Variable("tile_side", _spectrum, LATERAL, "side of the periodic tile"),
    Variable("n_point", _shape, "1", "points along a side of the tile"),
    Variable("tolerance", _shape, ADHESION, "largest force along the motion that may be left"),
    Variable(AMPLITUDE, (AMPLITUDE,), ADHESION, "requested e_el (chemical field: w_rms^2/4)"),
    Variable("w_rms_requested", (AMPLITUDE,), ADHESION, "requested rms, 2 sqrt(e_el w_int)"),
    Variable(REALISATION, (REALISATION,), "1", "number of the realisation"),
)

HYSTERESIS = (
    Variable("w_appr", _cell, ADHESION, "apparent work of adhesion in steady approach"),
    Variable("w_retr", _cell, ADHESION, "apparent work of adhesion in steady retraction"),
    Variable("w_appr_error", _cell, ADHESION, "standard error of w_appr over its states"),
    Variable("w_retr_error", _cell, ADHESION, "standard error of w_retr over its states"),
    Variable("w_appr_numerical_error", _cell, ADHESION, "expected numerical error of w_appr"),
    Variable("w_retr_numerical_error", _cell, ADHESION, "expected numerical error of w_retr"),
    Variable("hysteresis", _cell, ADHESION, "w_retr - w_appr"),
    Variable("midpoint", _cell, ADHESION, "(w_retr + w_appr) / 2"),
    Variable("w_appr_from_force", _cell, ADHESION, "w of the JKR curve fitted to the approach"),
    Variable("w_retr_from_force", _cell, ADHESION, "w of the JKR curve fitted to the retraction"),
    Variable("hysteresis_from_force", _cell, ADHESION, "difference of the two JKR curves' w"),
    *(Variable(item.name, _cell, item.units, item.long_name) for item in COSTS),
    Variable("iterations", _cell, "1", "sweeps of the solver, sum over the cycle"),
    Variable("n_step", _cell, "1", "states of the cycle"),
    Variable("n_approach", _cell, "1", "states that w_appr averages"),
    Variable("n_retraction", _cell, "1", "states that w_retr averages"),
    Variable("lowest_radius", _cell, LATERAL, "smallest mean radius of the steady window"),
    Variable("highest_radius", _cell, LATERAL, "largest mean radius of the steady window"),
    Variable("pull_off_force", _cell, FORCE, "lowest force of a full cycle"),
    Variable("end_penetration", _cell, VERTICAL, "penetration at which the cycle ended"),
    Variable("status", _cell, "1", "how it ended: lost_contact or steady where it is complete"),
    Variable("status_sentence", _cell, "1", "the same in words"),
    Variable("seed", _cell, "1", "numpy.random.default_rng(seed) gives the surface's noise"),
    Variable("curve", _cell, "1", "file of the simulation in the folder curves"),
)
