"""Whether the golden files bite: `python -m tests.golden.mutations [part of a name ...]`.

Each mutation changes one formula of the sources in a temporary copy, whose golden tests then run
until the first fails. All must fail but those of the equivalent mutations: these change the way of
a solver to the same front. The whole list takes about half an hour, since kernels are compiled for
every changed source.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]

COPIED = ("crackfront", "tests/golden", "tests/conftest.py", "pyproject.toml")
"""What the golden tests need of the project."""


class Mutation(NamedTuple):
    """One textual change of a source."""

    module: str
    """File below `crackfront`."""
    before: str
    """Text that occurs exactly once in it."""
    after: str
    name: str
    """What changes, in words."""


MUTATIONS = [
    Mutation("core/units.py", "MODULUS = 0.75", "MODULUS = 0.75000075", "modulus by 1e-6"),
    Mutation("core/units.py", "cube = 3 *", "cube = 3.000003 *", "lateral unit by 1e-6"),
    Mutation("core/jkr.py", " + a**5 / 5)", ")", "a term of the stored energy dropped"),
    Mutation(
        "core/jkr.py", "return 2 * radius - math", "return 2 * radius + math", "sign of slope"
    ),
    Mutation("core/jkr.py", "np.sqrt(8 * a *", "np.sqrt(8.000008 * a *", "JKR curve by 1e-6"),
    Mutation("core/adhesion.py", "1j * along_x +", "-1j * along_x +", "sign of q_x"),
    Mutation(
        "core/adhesion.py",
        "kernel[n_x // 2] = kernel[n_x // 2].real",
        "pass",
        "mean of both signs of the Nyquist mode dropped",
    ),
    Mutation("core/adhesion.py", "CONTACT_MODULUS / 4", "CONTACT_MODULUS / 4.000004", "e_el, 1e-6"),
    Mutation("core/adhesion.py", "2 * np.pi * force", "6.283191 * force", "Larkin length by 1e-6"),
    Mutation(
        "core/spectrum.py",
        "(-2 - 2 * self.hurst)",
        "(-2 - 2.000002 * self.hurst)",
        "exponent of the density by 1e-6",
    ),
    Mutation(
        "core/spectrum.py",
        "exponent = power * growth + np",
        "exponent = power * growth - np",
        "sign of a tabulated power law",
    ),
    Mutation(
        "core/synthesis.py",
        "spectrum.density(wavevector) / 2)",
        "spectrum.density(wavevector) / 2.000002)",
        "amplitude of modes by 5e-7",
    ),
    Mutation(
        "core/synthesis.py",
        "np.conj(modes[kept_x:0:-1, 0])",
        "modes[kept_x:0:-1, 0]",
        "conjugation dropped",
    ),
    Mutation(
        "core/synthesis.py",
        "2 * np.pi / (n_x * pixel) * np.arange(1, n_mode + 1)",
        "2 * np.pi / (n_x * pixel) * np.arange(n_mode)",
        "index of the rows' modes",
    ),
    Mutation("core/geometry/sphere.py", "/ (2 * np.pi)", "/ (2.000002 * np.pi)", "a G_JKR by 1e-6"),
    Mutation(
        "core/geometry/sphere.py",
        "return WORK_OF_ADHESION * mode",
        "return WORK_OF_ADHESION * 1.000001 * mode",
        "line elasticity by 1e-6",
    ),
    Mutation(
        "core/geometry/sphere.py", "0.5 * n_x, 0.5 * n_y", "0.5 * n_x, 0.5 * n_y - 1", "the apex"
    ),
    Mutation(
        "core/geometry/sphere.py",
        "return np.sqrt(max(load, 0.0))",
        "return 0.999999 * np.sqrt(max(load, 0.0))",
        "edge in compression by 1e-6",
    ),
    Mutation(
        "core/geometry/sphere.py",
        "np.mean(release) / np.mean(front)",
        "np.mean(release / front)",
        "mean that defines the apparent work",
    ),
    Mutation(
        "core/geometry/line.py",
        "geometry.stiffness * (place - load)",
        "geometry.stiffness * 1.000001 * (place - load)",
        "springs by 1e-6",
    ),
    Mutation(
        "core/geometry/line.py",
        "WORK_OF_ADHESION * 2 * np.pi / geometry.length * mode",
        "WORK_OF_ADHESION * 2.000002 * np.pi / geometry.length * mode",
        "line elasticity of a straight front by 1e-6",
    ),
    Mutation(
        "core/geometry/line.py", "-geometry.corner[0]", "geometry.corner[0]", "sign of the corner"
    ),
    Mutation(
        "core/field/fields.py",
        "modes /= np.sinc(rfftfreq(n_y))[None, :] ** 4",
        "modes /= np.sinc(rfftfreq(n_y))[None, :] ** 3",
        "spline coefficients along y",
    ),
    Mutation(
        "core/field/samples.py",
        "line[j + 2], line[j + 3]",
        "line[j + 3], line[j + 2]",
        "index of spline coefficients",
    ),
    Mutation(
        "core/field/samples.py",
        "weight_slope(field.geometry) * value + times * rise",
        "times * rise",
        "a term of the slope of samples dropped",
    ),
    Mutation(
        "core/field/samples.py",
        "4 - 3 * u * u * (2 - u)",
        "4 - 3.000003 * u * u * (2 - u)",
        "spline",
    ),
    Mutation(
        "core/field/pieces.py",
        "piece[0] + t * (3 * first",
        "piece[0] + t * (3.000003 * first",
        "value of a piece by 1e-6",
    ),
    Mutation(
        "core/field/rays.py", "total += values / 6 *", "total += values / 6.000006 *", "Simpson"
    ),
    Mutation(
        "core/solver/forces.py",
        "restoring_force(geometry, place[i], load) - line[i])",
        "restoring_force(geometry, place[i], load) - 0.999999 * line[i])",
        "line force of the fast solver by 1e-6",
    ),
    Mutation(
        "core/solver/forces.py",
        "modes[2 * n + 1] *= stiffness",
        "modes[2 * n + 1] *= 1.000001 * stiffness",
        "imaginary part of the modes by 1e-6",
    ),
    Mutation(
        "core/solver/reference.py",
        "force = product - restoring_force(geometry, place, load) - line[i]",
        "force = product - restoring_force(geometry, place, load) + line[i]",
        "sign of the line force of the reference",
    ),
    Mutation(
        "core/cycle/energy.py",
        "+ swept_adhesion(before",
        "- swept_adhesion(before",
        "sign of the swept adhesion",
    ),
    Mutation(
        "core/cycle/record.py",
        "self._turn = step.before",
        "self._turn = step.front",
        "front at which a branch begins",
    ),
    Mutation(
        "core/cycle/load_schedule.py",
        "if k * self.step >= self.max_penetration * (1 - 1e-12):",
        "if False:",
        "the largest penetration is visited twice",
    ),
    Mutation(
        "simulate/simulation.py", "self.realisation)", "self.realisation + 1)", "seed of the noise"
    ),
    Mutation(
        "simulate/tiles.py",
        "values *= 2 * math",
        "values *= 2.000002 * math",
        "amplitude of chemical fields by 1e-6",
    ),
    Mutation(
        "simulate/tiles.py", "math.sqrt(8 * surface", "math.sqrt(8.000008 * surface", "rows by 5e-7"
    ),
    Mutation(
        "simulate/sphere/steady_branches.py",
        "mean + 0.8 * (mean",
        "mean + 0.8000008 * (mean",
        "start of the retraction by 1e-6",
    ),
    Mutation(
        "simulate/line/line_loads.py",
        "step * np.arange(n_step + 1, dtype=float)",
        "step * np.arange(n_step, dtype=float)",
        "last load dropped",
    ),
    Mutation(
        "analysis/steady_adhesion.py", "midpoint=(w_retr + w", "midpoint=(w_retr - w", "midpoint"
    ),
    Mutation(
        "analysis/steady_adhesion.py",
        "inside = (place >= window[0])",
        "inside = (place > window[0])",
        "lower end of the window left out",
    ),
    Mutation(
        "analysis/steady_adhesion.py",
        "jkr.equilibrium_force(radius, 1.0)",
        "jkr.equilibrium_force(radius, 1.000001)",
        "w from force by 1e-6",
    ),
    Mutation(
        "analysis/standard_error.py",
        "1 + np.ptp(radius)",
        "np.ptp(radius)",
        "one independent state fewer",
    ),
    Mutation(
        "analysis/sweep_fit.py",
        "factor=(w_retr - w_appr) / (2 * energy)",
        "factor=(w_retr - w_appr) / (2.000002 * energy)",
        "k by 1e-6",
    ),
    Mutation(
        "analysis/sweep_fit.py",
        "depression=1 - (w_retr",
        "depression=1 + (w_retr",
        "sign of midpoint",
    ),
    Mutation(
        "analysis/sweep_law.py",
        "factor.value * gain.value, factor",
        "factor.value * 1.000001 * gain.value, factor",
        "k of the infinite contact by 1e-6",
    ),
    Mutation("analysis/estimate.py", "_CONFIDENCE = 0.95", "_CONFIDENCE = 0.950001", "intervals"),
    Mutation(
        "simulate/run_simulation.py",
        "return 1 - self.measures.e_el if",
        "return 1 if",
        "lowering of the mean of w_loc dropped",
    ),
    Mutation(
        "sweep/rows.py",
        "w_retr_numerical_error=numerical[1]",
        "w_retr_numerical_error=numerical[0]",
        "index of the numerical error",
    ),
]
"""Changes of formulas: each must make a golden test fail."""

EQUIVALENT = [
    Mutation(
        "core/geometry/sphere.py",
        "return 4 * RING * place",
        "return 4.000004 * RING * place",
        "bound on the stiffness of a ring by 1e-6: shorter steps",
    ),
    Mutation(
        "core/solver/monotone.py",
        "_EQUILIBRIUM = 0.3",
        "_EQUILIBRIUM = 0.2",
        "tolerance of a window of the whole front",
    ),
    Mutation(
        "core/solver/monotone.py",
        "first_least - _ROUND_OFF:",
        "first_least + 1.0:",
        "no step of the fast solver is trusted: all goes to the reference",
    ),
    Mutation("core/solver/forces.py", "GROWTH = 8", "GROWTH = 4", "limit on the growth of steps"),
    Mutation(
        "core/field/samples.py",
        "_CUBIC_MEMORY = 32",
        "_CUBIC_MEMORY = 64",
        "samples that are remembered",
    ),
]
"""Internal settings of the solvers: they change how a front is found, not which."""


def outcome(mutation: Mutation | None, folder: Path) -> tuple[bool, str]:
    """Whether the golden tests of mutated sources pass, and what fails first."""
    copy = folder / "copy"
    ignored = shutil.ignore_patterns("__pycache__")
    for name in COPIED:
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, copy / name, ignore=ignored)
        else:
            shutil.copy(ROOT / name, copy / name)
    if mutation is not None:
        source = copy / "crackfront" / mutation.module
        text = source.read_text()
        count = text.count(mutation.before)
        if count != 1:
            raise SystemExit(f"{mutation.module} has {mutation.before!r} {count} times, not once")
        source.write_text(text.replace(mutation.before, mutation.after))
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider"]
    # Folders of kernels are named by their sources, so that all mutations can share a cache.
    cache = {"NUMBA_CACHE_DIR": str(folder / "kernels"), "PYTHONPATH": str(copy)}
    run = subprocess.run(
        [*command, "tests/golden/test_golden.py"],
        cwd=copy,
        env=os.environ | cache,
        capture_output=True,
        text=True,
        check=False,
    )
    shutil.rmtree(copy)
    if run.returncode not in (0, 1):
        raise SystemExit(f"the tests of {mutation} did not run:\n{run.stdout}{run.stderr}")
    moved = re.findall(r"^.* moved by .*$|^.*has other entries.*$|^E  .*Error.*$", run.stdout, re.M)
    return run.returncode == 0, moved[0].strip() if moved else ""


def main(parts: list[str]) -> str | None:
    """Report the outcome of the mutations whose module or name has one of some parts, or of all."""
    wrong = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        passed, moved = outcome(None, folder)
        if not passed:
            return f"the golden tests fail without a mutation: {moved}"
        for mutation in MUTATIONS + EQUIVALENT:
            if parts and not any(part in f"{mutation.module} {mutation.name}" for part in parts):
                continue
            began = time.perf_counter()
            passed, moved = outcome(mutation, folder)
            if passed != (mutation in EQUIVALENT):
                wrong.append(mutation.name)
            seconds = time.perf_counter() - began
            verdict = "passes" if passed else "fails"
            line = f"{verdict:6} {mutation.module}: {mutation.name} ({seconds:.0f} s) {moved}\n"
            sys.stdout.write(line)
            sys.stdout.flush()
    return f"not as expected: {', '.join(wrong)}" if wrong else None


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
