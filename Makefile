# make demo | test | lint | bench | policies | wheels: each sets up .venv by itself when it is missing or older than what it is made from.
.DEFAULT_GOAL := help
ROBOTS := turtlebot3 jackal robotino
.PHONY: help demo test lint bench clean setup wheels policies
PYTHON ?= python3
BIN := .venv/bin
SOURCES := pyproject.toml constraints.txt $(wildcard plugins/*/pyproject.toml)

help:
	@echo "make demo   run the smoke experiment and print where its report is"
	@echo "make test   run all tests"
	@echo "make lint   ruff, mypy, import-linter"
	@echo "make bench  speed against named peers (installs the peers)"
	@echo "make policies  train every policy that comes with a package, two at a time; goes on where it was cut off"
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

policies: setup
	for planner in rosnav gring gring_as_released navrep; do printf "$$planner %s\n" $(ROBOTS); done | OMP_NUM_THREADS=1 xargs -P 2 -L 1 scripts/train_policy
	for planner in navrep_v_only aio; do printf "$$planner %s\n" $(ROBOTS); done | OMP_NUM_THREADS=1 xargs -P 2 -L 1 scripts/train_policy  # last: they use the world models and the policies of others

clean:
	rm -rf .venv dist build
