# Every target does its own set-up in .venv; all that is needed is Python 3.11+ and a package index.

PYTHON ?= python3
OUT ?= out
BIN := .venv/bin
READY := .venv/.ready

.PHONY: demo test lint bench package docs clean

demo: $(READY)
	$(BIN)/oodscen run $(OUT)

test: $(READY)
	OODSCEN_OFFLINE=1 $(BIN)/pytest -n 2 --dist loadfile --no-loadscope-reorder

lint: $(READY)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy oodscen adapters/oodscen_pybullet adapters/oodscen_carla adapters/oodscen_highway adapters/oodscen_sumo
	$(BIN)/mypy examples/*.py
	cd examples/driving_ci && ../../$(BIN)/mypy --config-file ../../pyproject.toml stack.py tests/test_stack.py
	$(BIN)/lint-imports --no-cache

bench: $(READY)
	status=0; for file in benchmarks/[a-z]*.py; do $(BIN)/python $$file --json || status=1; done; exit $$status

# EXTRAS="plots tables" installs these extras too, each alone in a fresh environment.
package: $(READY)
	$(BIN)/pip install --quiet -c constraints.txt -e '.[release]'
	$(BIN)/python -m tools.check_package dist $(EXTRAS)

# The site, in docs/_build; a warning is an error.
docs: $(READY)
	$(BIN)/pip install --quiet -c constraints.txt -e '.[docs]'
	$(BIN)/python -m sphinx -W --keep-going -q -b html docs docs/_build
	@echo docs/_build/index.html

clean:
	rm -rf .venv dist docs/_build docs/generated $(OUT)

$(READY): pyproject.toml constraints.txt
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/pip install --quiet -c constraints.txt torch
	$(BIN)/pip install --quiet -c constraints.txt -e '.[dev]'
	if command -v chromium >/dev/null; then $(BIN)/pip install --quiet -c constraints.txt -e '.[browser]' || echo "Playwright cannot be had: the report is not tested in a browser"; fi
	touch $(READY)
