# make demo   build the gallery of example maps into public/
# make test   lint, types, tests, pages in a real browser
# make prove  longer proofs than make test has time for
# make bench  speed, memory and size, beside peers and floors; writes docs/benchmarks (needs Node)
# make experiments   the paper's experiments beside ours; writes docs/experiments

PYTHON ?= python3
BIN := .venv/bin

.PHONY: demo test lint prove bench schema golden figures experiments clean

demo: .venv/.package
	$(BIN)/geotween build scenes/*.yaml -o public

test: .venv/.tests .venv/.browser lint
	$(BIN)/pytest -n auto

lint: .venv/.tests
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

prove: .venv/.tests
	HYPOTHESIS_PROFILE=prove $(BIN)/pytest -n auto tests --ignore tests/browser

bench: .venv/.tests benchmarks/node_modules
	$(BIN)/python -m benchmarks

# What the code writes and the repository keeps; look at the difference before committing it.
schema: .venv/.package
	$(BIN)/geotween schema > scenes/scene.schema.json

golden: .venv/.tests
	$(BIN)/pytest tests/test_golden.py --update-golden

figures: .venv/.tests
	$(BIN)/python -m docs.draw

# With flubber where there is Node; without it the pages say so.
experiments: .venv/.package $(if $(shell command -v npm),benchmarks/node_modules)
	$(BIN)/python -m docs.draw.experiments

.venv/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "geotween needs Python 3.11 or newer; name one: make PYTHON=python3.12"; exit 1; }
	$(PYTHON) -m venv .venv

.venv/.package: .venv/bin/python pyproject.toml
	$(BIN)/pip install --quiet --disable-pip-version-check -e '.[geo,hotspots]'
	@touch $@

.venv/.tests: .venv/bin/python pyproject.toml
	$(BIN)/pip install --quiet --disable-pip-version-check -e '.[test]'
	@touch $@ .venv/.package

.venv/.browser: .venv/.tests
	$(BIN)/python tests/browser/chromium.py
	@touch $@

benchmarks/node_modules: benchmarks/package-lock.json
	cd benchmarks && npm ci --silent
	@touch $@

clean:
	rm -rf .venv public benchmarks/node_modules
