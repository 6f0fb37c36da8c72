# make demo | test | lint | bench | docs: each sets up .venv by itself when it is missing or older than what it is made from.
.DEFAULT_GOAL := help
.PHONY: help demo test lint bench clean setup wheels
PYTHON ?= python3
BIN := .venv/bin
SOURCES := pyproject.toml constraints.txt $(wildcard plugins/*/pyproject.toml)

help:
	@echo "make demo   run the smoke experiment and print where its report is"
	@echo "make test   run all tests"
	@echo "make lint   ruff, mypy, import-linter"
	@echo "make bench  speed against named peers (installs the peers)"
	@echo "make wheels build wheels and try them in an empty environment"

setup: .venv/.complete

.venv/.complete: $(SOURCES) scripts/setup
	PYTHON=$(PYTHON) scripts/setup
	@touch $@

demo: setup
	$(BIN)/arena run experiment=smoke

test: setup
	$(BIN)/pytest

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: setup
	scripts/setup bench
	$(BIN)/python -m benchmarks

wheels: setup
	scripts/try_wheels

clean:
	rm -rf .venv dist build
