# Every target does its own set-up in .venv; all that is needed is Python 3.11+ and a package index.

PYTHON ?= python3
OUT ?= out
BIN := .venv/bin
READY := .venv/.ready

.PHONY: demo test lint bench clean

demo: $(READY)
	$(BIN)/oodscen run $(OUT)

test: $(READY)
	OODSCEN_OFFLINE=1 $(BIN)/pytest -n 2 --dist loadfile --no-loadscope-reorder

lint: $(READY)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy oodscen adapters/oodscen_pybullet adapters/oodscen_carla adapters/oodscen_highway adapters/oodscen_sumo
	$(BIN)/lint-imports --no-cache

bench: $(READY)
	status=0; for file in benchmarks/[a-z]*.py; do $(BIN)/python $$file --json || status=1; done; exit $$status

clean:
	rm -rf .venv $(OUT)

$(READY): pyproject.toml constraints.txt
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/pip install --quiet -c constraints.txt torch
	$(BIN)/pip install --quiet -c constraints.txt -e '.[dev]'
	if command -v chromium >/dev/null; then $(BIN)/pip install --quiet -c constraints.txt -e '.[browser]' || echo "Playwright cannot be had: the report is not tested in a browser"; fi
	touch $(READY)
