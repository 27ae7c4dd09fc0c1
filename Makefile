# Two commands for a fresh machine with Python and make: `make demo` and `make test`.
PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
OUT    ?= build/paper
# One thread a worker: the suite runs two workers, and small matrices lose by threading. A file goes to one worker, so
# that what its tests share is made once. What is compiled is kept, whatever the surroundings say of that: each worker,
# and each program that a test starts, would compile all that it imports.
TESTENV := OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 MPLBACKEND=Agg PYTHONDONTWRITEBYTECODE=

.PHONY: kernels demo test lint types suite reliability nightly chart docs clean

demo: $(VENV)/.demo
	$(BIN)/continuation paper --output $(OUT)

test: lint types suite

lint: $(VENV)/.dev
	$(BIN)/ruff check continuation problems tests examples

types: $(VENV)/.dev
	$(BIN)/mypy

suite: $(VENV)/.dev
	$(TESTENV) $(BIN)/pytest -n 2 --dist loadfile

# The suite under each kernel of OpenBLAS, with fewer instructions, more threads, the oldest packages and every Python:
# one to two hours. `.ci/kernels NAME ... -- TESTS` runs some of it.
kernels: $(VENV)/.dev
	VENV=$(VENV) $(BIN)/python .ci/kernels

# Kills, damage, bad input and the rest by the thousand, in two processes; the table is build/reliability/table.md.
reliability: $(VENV)/.dev
	$(TESTENV) $(BIN)/python -m tests.reliability.run --output build/reliability

# Every tube of the proofs of the suite by python-flint, another arithmetic by other authors; two minutes.
nightly: $(VENV)/.proof
	$(TESTENV) $(BIN)/pytest tests/continuation/certificate -k flint

$(VENV)/bin/python:
	$(PYTHON) -m venv $(VENV)

$(VENV)/.demo: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[plot,progress]"
	touch $@

$(VENV)/.proof: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[test]" "python-flint>=0.6"
	touch $@

# With the other software, in an environment of its own: some of it would change what the library does.
$(VENV)-chart/.done: pyproject.toml
	$(PYTHON) -m venv $(VENV)-chart
	$(VENV)-chart/bin/python -m pip install --quiet --disable-pip-version-check -e ".[chart,progress]"
	touch $@

$(VENV)/.docs: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[docs]"
	touch $@

$(VENV)/.dev: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[dev]"
	touch $@ $(VENV)/.demo

# The studies of speed against accuracy, at a moderate size, ours and other software: tables and pictures in build/chart.
# Then the pictures and tables of the documentation are made anew, and what its pages say is checked: a quarter of an hour
# on a quiet machine of two cores. The longest studies first, so that two processes end together.
STUDIES := engine lcp robustness scaling scenes
chart: $(VENV)-chart/.done
	$(MAKE) -j2 $(STUDIES:%=chart-%)
	$(TESTENV) $(VENV)-chart/bin/python examples/draw_images.py
	$(TESTENV) $(VENV)-chart/bin/python docs/generate_choosing.py build/chart
$(STUDIES:%=chart-%): chart-%: $(VENV)-chart/.done
	$(TESTENV) $(VENV)-chart/bin/continuation chart $* --compare --output build/chart

docs: $(VENV)/.docs
	$(BIN)/python docs/generate_constants.py
	$(TESTENV) $(BIN)/python -m sphinx -b html -W --keep-going docs build/docs

clean:
	rm -rf $(VENV) $(VENV)-chart build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis
	find continuation problems tests examples docs -name __pycache__ -prune -exec rm -rf {} +
