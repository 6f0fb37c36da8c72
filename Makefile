# Each target sets up .venv by itself when it is missing or older than what it is made from.
.DEFAULT_GOAL := help
ROBOTS := turtlebot3 jackal robotino
# What needs more than Python: a marker in pyproject.toml, a case in scripts/setup and scripts/NAME.txt, a name here. make test-NAME runs it.
APART := browser ros1 ros2 pictures
.PHONY: help demo test test-slow test-plain test-portable test-js long mutants lint lint-js bench clean setup wheels dist policies fuzz coverage docs results-check $(APART:%=test-%)
PYTHON ?= python3
PLUGIN ?=
READY ?=
SLOW ?=
AREA ?=
FIRST ?= 40
WORKERS ?= $(shell $(PYTHON) -c 'import os; print(os.cpu_count() + 1)')
FUZZ_EXAMPLES ?= 4200
BIN := .venv/bin
SOURCES := pyproject.toml constraints.txt scripts/tools.txt $(wildcard plugins/*/pyproject.toml)
unexport PYTHONDONTWRITEBYTECODE  # a suite of many processes: compile each module once
ONE_THREAD := OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1  # threads of libraries wait by spinning: beside other tests they take five times as long
PYTEST := $(ONE_THREAD) $(BIN)/pytest -n $(WORKERS) --dist worksteal

help:
	@echo "make demo   drive two classic planners and a learned one among few and many people, say who breaks and how sure that is, and where the report is"
	@echo "make test   run the tests, one more at a time than there are cores (some wait for a clock); WORKERS=N: N at a time; SLOW=1: with those of test-slow; PLUGIN=arena-dwa: all of that package"
	@echo "make test-slow  run those that take more than a few seconds each: kills, faults, trainings, whole runs"
	@echo "make test-plain  run the kernels' tests with numba's own njit and cache, and nothing of ours around them"
	@echo "make test-browser  open the report's page and the documentation in chromium (installs it)"
	@echo "make test-ros1  drive a simulated robot over a ROS 1 master (installs rosmaster and rospy with apt)"
	@echo "make test-ros2  drive a simulated robot between nodes of rclpy and of DDS (installs wheels of ROS 2 Jazzy, and builds Nav2's interfaces with gcc)"
	@echo "make test-pictures  drive every robot in 3-D and draw it (installs a driver that draws without a display)"
	@echo "make coverage  run all tests and tell which lines none of them reaches"
	@echo "make long   the long studies: every fault at every moment, a sweep killed again and again, 10,000 episodes in one worker, how often intervals hold the truth; and what others stand for in make test"
	@echo "make mutants  plant faults in kernels, metrics, rewards and costs, one at a time, and count those that tests find (an hour); AREA=statistics: those alone"
	@echo "make lint   ruff, mypy, import-linter"
	@echo "make lint-js  ESLint, TypeScript and Prettier on the pages' JavaScript (installs them beside it; needs node)"
	@echo "make test-js  the unit tests of the pages' JavaScript, by node's own runner"
	@echo "make docs   build the documentation into site/"
	@echo "make fuzz   a hundred thousand spoilt files for all readers, ten thousand spoilt requests for the studio (an hour); FUZZ_EXAMPLES=N: N for each"
	@echo "make results-check  drive 40 episodes of experiment=paper again and say which are not those of docs/results/check.json; FIRST=N: N of them"
	@echo "make bench  speed against named peers (installs the peers)"
	@echo "make policies  train every policy that comes with a package, two at a time; goes on where it was cut off"
	@echo "make wheels build wheels and try arena-suite with five extras, each in an empty environment"
	@echo "make dist   build wheels and sdists of a release into dist/; READY=DIR: one with the kernels too that arena compile out=DIR has made"

setup: .venv/.complete

.venv/.complete: $(SOURCES) scripts/setup
	PYTHON=$(PYTHON) scripts/setup
	@touch $@

.venv/.%: .venv/.complete scripts/%.txt
	scripts/setup $*
	@touch $@

.venv/.ros2: scripts/build_interfaces.py $(wildcard plugins/arena-ros/src/arena_ros/interfaces/*/*/*)

demo: setup
	$(BIN)/arena run experiment=demo

test: setup
	$(PYTEST) $(if $(PLUGIN)$(SLOW),$(PLUGIN:%=plugins/%),-m "not slow and not long and not browser and not ros1 and not ros2 and not pictures")

test-slow: setup  # only files that have some are looked through: looking through all takes every process 20 s
	$(PYTEST) -m "slow and not long and not browser and not ros1 and not ros2 and not pictures" $(shell grep -rl "mark\.slow" --include="test_*.py" tests plugins/*/tests)

test-plain: setup
	ARENA_KERNELS=plain NUMBA_CACHE_DIR=$(CURDIR)/build/kernels $(PYTEST) plugins/arena-kernels

test-portable: setup  # as on a system without POSIX
	ARENA_PORTABLE=1 $(PYTEST) -m "not slow and not long and not browser and not ros1 and not ros2 and not pictures" tests $(filter-out plugins/arena-ros plugins/arena-cluster,$(wildcard plugins/*))

test-browser: node_modules/.complete  # axe, which looks whether pages are accessible
test-browser: SPREAD := -n $(WORKERS) --dist loadfile  # a browser for each file
test-ros1 test-ros2: SPREAD := -n 2 --dist load  # they wait for clocks; each process has a master or a domain of its own

$(APART:%=test-%): test-%: .venv/.%
	$(BIN)/pytest $(SPREAD) -m $* $(wildcard tests/$* plugins/*/tests/$*)

coverage: setup
	$(PYTEST) --cov --cov-report=term --cov-report=html:build/coverage $(PLUGIN:%=plugins/%)

long: setup
	$(BIN)/pytest -m long
	ARENA_REPLICATIONS=1000 $(BIN)/pytest -s plugins/arena-metrics/tests/test_interval_coverage.py

mutants: setup
	nice $(BIN)/python benchmarks/mutants.py $(AREA)

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/python scripts/contracts.py

node_modules/.complete: package.json
	@command -v npm >/dev/null || { echo "npm is missing: apt-get install nodejs npm, or Node.js 20 or newer from nodejs.org" >&2; exit 2; }
	npm install --no-package-lock --no-audit --no-fund --loglevel=error
	@touch $@

lint-js: node_modules/.complete
	node_modules/.bin/tsc
	node_modules/.bin/eslint --max-warnings 0 eslint.config.js scripts plugins
	node_modules/.bin/prettier --check --log-level warn '*.js' 'scripts/*.js' 'plugins/**/*.{js,css}' 'docs/**/*.{js,css}'

test-js: node_modules/.complete
	node --import ./scripts/names.js --test --test-reporter=spec $(wildcard plugins/*/tests/js/*.test.js)

docs: .venv/.docs
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict

fuzz: setup
	FUZZ_EXAMPLES=$(FUZZ_EXAMPLES) $(BIN)/pytest tests/fuzz -q -s
	FUZZ_REQUESTS=10000 $(BIN)/pytest plugins/arena-studio/tests/test_studio_fuzz.py -q -s

results-check: setup
	$(BIN)/python scripts/results_check.py --first $(FIRST)

bench: setup
	scripts/setup bench
	$(BIN)/python -m benchmarks

wheels: setup
	scripts/try_wheels

dist: setup
	scripts/build_dist dist $(READY)

policies: setup
	{ echo rosnav jackal_ackermann; for planner in rosnav rosnav_as_paper gring gring_as_released navrep navrep_as_released cadrl sarl; do printf "$$planner %s\n" $(ROBOTS); done; } | OMP_NUM_THREADS=1 xargs -P 2 -L 1 scripts/train_policy
	{ echo rosnav_rewards turtlebot3; for planner in navrep_v_only aio aio_as_released; do printf "$$planner %s\n" $(ROBOTS); done; } | OMP_NUM_THREADS=1 xargs -P 2 -L 1 scripts/train_policy  # last: they use the world models and the policies of others

clean:
	rm -rf .venv node_modules dist build site
