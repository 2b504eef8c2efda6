# make            create the environment, run the sweep SWEEP to its figure and fit
# make test       create the environment, run the tests
# make help       all targets
#
# Variables
#   SWEEP=config/default.yaml   the configuration that `make` runs; results in results/<its name>/
#   SCALE=quick | paper         coarser lengths, or the paper's, for `make figures`
#   VALIDATION=config/validation.yaml   sizes of `make validate`; config/validation-512.yaml
#                               and config/validation-1024.yaml are hours
#   PORTABLE=1                  compute as another processor would: numpy, its BLAS and numba without
#                               vector units, BLAS on three threads
#   PROFILE=workflow/profiles/default   profile of Snakemake; one of a cluster runs all rules there
#   PYTHON=python3              the interpreter that .venv is made from (3.11 or newer)
#   MPI=wheel | system          wheel (default): MPICH from the package index, no system MPI needed.
#                               system: for a cluster. mpi4py is built from its source release against
#                               the MPI whose mpicc is first on PATH (or in MPICC), so load that MPI's
#                               module first; this needs its compiler and headers. `mpiexec` (or srun)
#                               is then the system's. The choice is remembered until .venv is removed.

SWEEP  ?= config/default.yaml
SCALE  ?= quick
VALIDATION ?= config/validation.yaml
PROFILE ?= workflow/profiles/default
PORTABLE ?=
PYTHON ?= python3
MPI    ?= $(if $(wildcard .venv/.packages-system),system,wheel)

ifeq ($(filter wheel system,$(MPI)),)
$(error MPI=$(MPI) is unknown; use MPI=wheel or MPI=system)
endif

# Without its cache of bytecode Python compiles all packages at every start.
unexport PYTHONDONTWRITEBYTECODE
export PYTHONNOUSERSITE := 1

# The name of the results of a path, which may have spaces or quotes, and the path for a shell.
stem     = $(basename $(notdir $(subst $() $(),?,$(1))))
quoted   = '$(subst ','\'',$(1))'

RESULTS  = results/$(call stem,$(SWEEP))/
VALIDATED = results/$(call stem,$(VALIDATION))/
REPORT   = results/tests/junit.xml
IN_ENV   = PATH="$(CURDIR)/.venv/bin:$$PATH" OMP_NUM_THREADS=1 $(if $(PORTABLE),$(NO_VECTORS))
DISPATCHED = from numpy._core._multiarray_umath import __cpu_dispatch__ as names; print(*names)
NO_VECTORS = NPY_DISABLE_CPU_FEATURES="$$(.venv/bin/python -c '$(DISPATCHED)')" \
  OPENBLAS_CORETYPE=Nehalem OPENBLAS_NUM_THREADS=3 NUMBA_CPU_NAME=generic NUMBA_CPU_FEATURES=
START    = $(IN_ENV) .venv/bin/python workflow/run.py
PROFILED = --profile $(call quoted,$(PROFILE))
SNAKE    = $(START) $(PROFILED)
# uv installs, or pip where uv cannot be had or where PIP_NO_INDEX says that only pip knows the files.
FLAGS    = --no-deps --no-build-isolation --quiet
PIP      = PIP_USE_PEP517=1 .venv/bin/python -m pip install $(FLAGS) --no-compile
UV       = .venv/bin/uv pip install $(FLAGS) --python .venv
install  = { $(if $(PIP_NO_INDEX),false,[ -x .venv/bin/uv ] && $(UV) $(1)) || $(PIP) $(1); }
# Tests on all cores, of which eight are enough; one that is done takes from another.
PARALLEL = -n auto --maxprocesses 8 --dist worksteal
PACKAGES = .venv/.packages-$(MPI)
READY    = .venv/.ready-$(MPI)

# The blocks of the lock whose package matches the pattern $(1); those that do not with $(2) = !
locked   = awk '/^[^ ]/ { kept = $(2)/^($(1))==/ } kept' requirements.lock

.DEFAULT_GOAL := all
.PHONY: all env test test-portable test-cluster nightly law accuracy validate benchmark canaries timings reproduce reproduce-fronts reproduce-scans \
  reproduce-boundary figures report docs lint lock clean help

all: env  ## Run the sweep SWEEP to its fit and figures
	@$(START) --plan $(call quoted,$(SWEEP)) $(PROFILED) --quiet all --config sweep=$(call quoted,$(SWEEP))
	@echo "Dataset: $(RESULTS)hysteresis.nc"
	@sed -n 's/^- //p; /^  /p; /^## /q' $(RESULTS)fit.md
	@echo "Fit:     $(RESULTS)fit.md"
	@echo "Figures: $(RESULTS)figures/{hysteresis,factor,loop}.png"
	@echo "Page:    $(RESULTS)summary.html"

env: $(READY)  ## Create .venv from requirements.lock

# Starts from an empty .venv, so that nothing of an older lock stays behind. The build tools come
# first: a package without a wheel is then built by locked tools, not by whatever is newest.
$(PACKAGES): requirements.lock
	@command -v "$(PYTHON)" >/dev/null || { \
	  echo "The interpreter '$(PYTHON)' is missing; install Python 3.11 or newer or name one: make env PYTHON=python3.12" >&2; exit 1; }
	@"$(PYTHON)" -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	  echo "'$(PYTHON)' is $$("$(PYTHON)" -V 2>&1); crackfront needs Python 3.11 or newer: make env PYTHON=python3.12" >&2; exit 1; }
	@rm -rf .venv
	@if "$(PYTHON)" -c 'import ensurepip, venv' 2>/dev/null; then "$(PYTHON)" -m venv .venv; \
	elif command -v virtualenv >/dev/null; then virtualenv --quiet --python "$(PYTHON)" .venv; \
	elif command -v uv >/dev/null; then uv venv --quiet --seed --python "$(PYTHON)" .venv; \
	else echo "'$(PYTHON)' cannot create a virtual environment; run 'apt-get install python3-venv' (as root) and repeat" >&2; exit 1; fi
	@echo "Installing requirements.lock into .venv (half a minute; two where uv cannot be had) ..."
	@$(call locked,uv) > .venv/lock-uv.txt
	@$(call locked,setuptools|cython) > .venv/lock-build.txt
	@$(call locked,mpi4py) > .venv/lock-mpi4py.txt
	@$(call locked,(uv$(if $(filter system,$(MPI)),|mpi4py|mpich)),!) > .venv/lock-rest.txt
	@$(if $(PIP_NO_INDEX),,$(PIP) --require-hashes --only-binary uv --requirement .venv/lock-uv.txt 2>/dev/null || true)
	@$(call install,--require-hashes --requirement .venv/lock-build.txt)
	@$(call install,--require-hashes --only-binary mpi4py --only-binary mpich --requirement .venv/lock-rest.txt)
ifeq ($(MPI),system)
	@$(call install,--require-hashes --no-binary mpi4py --no-cache-dir --requirement .venv/lock-mpi4py.txt)
endif
	@touch $@

$(READY): $(PACKAGES) pyproject.toml
	@$(call install,--editable .)
	@.venv/bin/python -m pip check --quiet
ifeq ($(MPI),wheel)
	@$(IN_ENV) mpiexec -n 2 .venv/bin/python -c 'from mpi4py import MPI; assert MPI.COMM_WORLD.size == 2' || { \
	  echo "mpiexec and mpi4py in .venv do not belong together; run 'make clean env'" >&2; exit 1; }
endif
	@$(IN_ENV) .venv/bin/crackfront compile
	@touch $@
	@echo "Environment: .venv ($$(.venv/bin/python -V), MPI=$(MPI))"

test: env  ## Run the tests that are not slow
	@mkdir -p $(dir $(REPORT))
	@echo "Test report: $(REPORT)"
	@$(IN_ENV) .venv/bin/python -m pytest $(PARALLEL) -m "not slow" --junitxml=$(REPORT)

test-portable: private PORTABLE = 1
test-portable: env  ## Run the tests of predictions and golden files as on another processor (three minutes)
	@$(IN_ENV) .venv/bin/python -m pytest $(PARALLEL) -m "not slow" \
	  tests/golden tests/measured/density tests/measured/spectrum tests/measured/prediction

ON_SLURM = $(IN_ENV) tests/cluster/with-slurm.sh .venv/bin/python -m pytest -m slurm --timeout 1800 tests/cluster

test-cluster: env  ## Run the tests that need a Slurm, on one started for them (5 minutes)
	@$(ON_SLURM)

nightly: env  ## Run all tests, the slow ones and those on a Slurm too, and the canaries
	@mkdir -p $(dir $(REPORT))
	@echo "Test report: $(REPORT)"
	@$(IN_ENV) .venv/bin/python -m studies canaries; canaries=$$?; \
	  $(IN_ENV) .venv/bin/python -m pytest $(PARALLEL) --junitxml=$(REPORT); passed=$$?; \
	  [ $$passed -le 1 ] && $(ON_SLURM) && [ $$passed = 0 ] && exit $$canaries

canaries: env  ## Measure some numbers of every study again, and compare them with the stored ones (a minute)
	@$(IN_ENV) .venv/bin/python -m studies canaries

benchmark: env  ## Solvers against the reference, what requests cost, how sweeps scale (an hour)
	$(IN_ENV) .venv/bin/python -m studies speed solvers
	$(IN_ENV) .venv/bin/python -m studies speed needs
	$(IN_ENV) .venv/bin/python -m studies speed costs
	$(IN_ENV) .venv/bin/python -m studies speed scaling
	@echo "Results: results/benchmark/"

timings: env  ## For a release: what depends on the machine (an hour)
	$(IN_ENV) .venv/bin/python -m studies speed solvers --keep
	$(IN_ENV) .venv/bin/python -m studies speed needs --keep
	$(IN_ENV) .venv/bin/python -m studies speed costs --keep
	$(IN_ENV) .venv/bin/python -m studies speed scaling --keep
	$(IN_ENV) .venv/bin/python -m studies pages

# For a release. It resumes: rules that are done are not run again, and boundary elements keep every
# load step. The studies of scans begin again, each in minutes.
reproduce: env  ## For a release: numbers and figures of the pages, but for timings and reproduce-boundary (6 core hours)
	$(MAKE) --no-print-directory --jobs 2 reproduce-fronts reproduce-scans
	$(MAKE) --no-print-directory accuracy
	cp results/accuracy/laws.png results/accuracy/work-precision.png docs/figures/
	cp results/validation/differences.nc $(KEPT)/validation/differences-256.nc
	for sweep in hurst $(ANY_SURFACE); do \
	  cp results/$$sweep/hysteresis.nc $(KEPT)/$$sweep.nc || exit 1; done
	for figure in hysteresis factor loop; do \
	  cp results/hurst/figures/$$figure.png docs/figures/hurst-$$figure.png || exit 1; done
	cp $(addprefix results/figures/paper/,$(addsuffix .nc,$(PAPER))) $(KEPT)/
	$(IN_ENV) .venv/bin/python -m studies law spheres config/spheres.yaml --output $(KEPT)
	$(IN_ENV) .venv/bin/python -m studies law held-out --output $(KEPT)
	$(IN_ENV) .venv/bin/python -m studies paper gallery
	$(IN_ENV) .venv/bin/python -m studies paper experiment --keep
	$(IN_ENV) .venv/bin/python -m studies accuracy report --keep
	$(IN_ENV) .venv/bin/python -m studies boundary-elements numbers --keep
	$(IN_ENV) .venv/bin/python -m studies law figure
	$(IN_ENV) .venv/bin/python -m studies law numbers --keep
	$(IN_ENV) .venv/bin/python -m studies canaries --keep
	$(IN_ENV) .venv/bin/crackfront predict examples/scans/nanodiamond-*.al3d --modulus 0.7MPa --poisson 0.5 \
	  --radius 1.25mm --work-of-adhesion 63mJ/m2 --figure docs/figures/prediction.png
	$(IN_ENV) .venv/bin/crackfront predict examples/scans/nanodiamond-*.al3d --modulus 0.7MPa --poisson 0.5 \
	  --radius 1.25mm --work-of-adhesion 63mJ/m2 --panel c --figure docs/figures/prediction-force.png
	$(IN_ENV) .venv/bin/python -m studies pages
	$(MAKE) --no-print-directory docs
	cd docs/examples/images && cp sphx_glr_a_first_loop_001.png ../../figures/tutorial-loop.png \
	  && cp sphx_glr_a_first_loop_002.png ../../figures/tutorial-fronts.png \
	  && cp sphx_glr_c_instabilities_001.png ../../figures/tutorial-jumps.png \
	  && cp sphx_glr_d_si_units_001.png ../../figures/tutorial-si.png \
	  && cp sphx_glr_k_hurst_001.png ../../figures/hurst.png \
	  && cp sphx_glr_l_any_surface_001.png ../../figures/any-surface.png

# Results without wall times, so that both may run at once: simulations on all cores, and studies on one.
reproduce-fronts: env
	$(MAKE) --no-print-directory law
	$(MAKE) --no-print-directory figures SCALE=paper
	$(MAKE) --no-print-directory validate VALIDATION=config/validation.yaml
	$(SNAKE) --config sweep=config/spheres.yaml
	for sweep in hurst $(ANY_SURFACE); do \
	  $(SNAKE) --config sweep=config/$$sweep.yaml || exit 1; done

reproduce-scans: env
	$(IN_ENV) .venv/bin/python -m studies accuracy energies --scans 12 --keep
	$(IN_ENV) .venv/bin/python -m studies accuracy movement --keep
	$(IN_ENV) .venv/bin/python -m studies accuracy loops --loops 20 --keep
	$(IN_ENV) .venv/bin/python -m studies accuracy predictions --keep
	$(IN_ENV) .venv/bin/python -m studies accuracy energy-balance --keep
	$(IN_ENV) .venv/bin/python -m studies accuracy individual-pinning --keep

law: env  ## The law of k, from its straight fronts, into results/law (an hour of one core)
	$(IN_ENV) .venv/bin/python -m studies law configurations
	set -e; for sweep in $(FRONTS_OF_LAW); do $(SNAKE) --config sweep=$$sweep; done
	$(IN_ENV) .venv/bin/python -m studies law fit $(FRONTS_OF_LAW)

FRONTS_OF_LAW = config/line.yaml results/law/configurations/*.yaml
KEPT = docs/reference
PAPER = main-3cd main-5bc si-5 beyond-avalanches beyond-roughness
ANY_SURFACE = bandpass anisotropic skewed
LARGE = 512 1024 series strong fine edges

reproduce-boundary: env  ## For a release: the numbers and figures of large boundary elements (a day of one core)
	set -e; for name in $(LARGE); do $(MAKE) --no-print-directory validate VALIDATION=config/validation-$$name.yaml; done
	cp results/validation-512/differences.nc $(KEPT)/validation/differences-512.nc
	cp results/validation-512/picture.nc $(KEPT)/validation/picture-512.nc
	cp results/validation-512/validation.png docs/figures/validation.png
	cp results/validation-series/differences.nc $(KEPT)/validation/differences-series.nc
	cp results/validation-strong/hysteresis.nc $(KEPT)/validation/hysteresis-strong.nc
	cp results/validation-fine/hysteresis.nc $(KEPT)/validation/hysteresis-fine.nc
	cp results/validation-strong/hysteresis.png docs/figures/validation-strong.png
	cp results/validation-edges/edges.nc $(KEPT)/validation/edges.nc
	cp results/validation-edges/edges.png docs/figures/validation-edges.png
	$(IN_ENV) .venv/bin/python -m studies boundary-elements numbers --keep
	$(IN_ENV) .venv/bin/python -m studies pages

accuracy: env  ## Errors of all numerics of docs/experiments/numerics.md (2.3 core hours)
	$(SNAKE) accuracy
	@echo "Results: results/accuracy/"

validate: env  ## The model against boundary elements (6 minutes); VALIDATION=config/validation-512.yaml
	$(SNAKE) --config validation=$(call quoted,$(VALIDATION)) -- validation
	@echo "Results: $(VALIDATED)validation.md"

figures: env  ## All figures of the paper; SCALE=quick (4 minutes) or SCALE=paper (25)
	$(SNAKE) --config scale=$(SCALE) -- figures
	@echo "Results: results/figures/$(SCALE)/, checks in results/figures/checks.md"
	@sed -n '3,/^$$/s/^- //p' results/figures/checks.md

report: env  ## Run what is missing of the sweep SWEEP; write one page of HTML: fit, figures, configuration
	$(SNAKE) --config sweep=$(call quoted,$(SWEEP))
	$(SNAKE) --config sweep=$(call quoted,$(SWEEP)) --report $(RESULTS)report.html
	@echo "Report: $(RESULTS)report.html"

docs: env  ## Pages in docs/_build/html, examples executed, warnings as errors (a minute)
	@rm -rf docs/_build docs/api docs/examples
	@$(IN_ENV) .venv/bin/python -m sphinx -W --keep-going --quiet -b html docs docs/_build/html
	@echo "Documentation: docs/_build/html/index.html"

lint: env  ## Style, format, types, import layers, format of the rules
	.venv/bin/ruff check
	.venv/bin/ruff format --check
	.venv/bin/mypy
	.venv/bin/lint-imports
	.venv/bin/snakefmt --check Snakefile workflow

lock:  ## Resolve pyproject.toml anew into requirements.lock
	@tools=$$(mktemp -d) && trap 'rm -rf "$$tools"' EXIT \
	&& "$(PYTHON)" -m venv "$$tools" && "$$tools/bin/pip" install --quiet uv \
	&& "$$tools/bin/uv" pip compile --quiet --no-config --upgrade --universal --python-version 3.11 --fork-strategy fewest \
	  --generate-hashes --no-emit-index-url --no-annotate --no-header \
	  --extra dev --extra mpich --output-file requirements.lock pyproject.toml >/dev/null
	@echo "Locked: requirements.lock"

clean:  ## Remove .venv and caches, never results
	rm -rf .venv .pytest_cache .hypothesis .mypy_cache .ruff_cache .import_linter_cache build *.egg-info \
	  docs/_build docs/api docs/examples
	find crackfront studies tests workflow -type d -name __pycache__ -prune -exec rm -rf {} + 2>/dev/null || true

help:  ## Show this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-19s %s\n", $$1, $$2 }' Makefile
	@echo "Variables: SWEEP=$(SWEEP) PROFILE=$(PROFILE) PYTHON=$(PYTHON) MPI=$(MPI) (see the top of the Makefile)"
