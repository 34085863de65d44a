# Everything runs in .venv, which is made when needed. "make test" and "make demo" need only CPython >= 3.10
# with venv, a C++ compiler and make: ROS 2 Jazzy itself comes as Python wheels.
PYTHON ?= python3
VENV := .venv
RUN := $(VENV)/bin/python

MESSAGES := $(shell find hgma_msgs -type f -not -path '*/build/*')

# A sourced ROS, or another environment with ROS wheels, would put its own modules and libraries before ours. The
# marker tells the wheels that the library path is set already; inherited from elsewhere, that is not true.
ifneq ($(AMENT_PREFIX_PATH)$(_ROS_WHEELS_BOOTSTRAP_COMPLETE),)
unexport LD_LIBRARY_PATH
endif
unexport PYTHONPATH AMENT_PREFIX_PATH CMAKE_PREFIX_PATH COLCON_PREFIX_PATH RMW_IMPLEMENTATION
unexport _ROS_WHEELS_BOOTSTRAP_COMPLETE
export PIP_DISABLE_PIP_VERSION_CHECK := 1
export PIP_PREFER_BINARY := 1

.PHONY: setup demo live test lint types chamber-table chamber-sensitivity chamber-diagnosis loop-benchmark paper-table soak bench
.PHONY: fleet-benchmark pictures clean FORCE
.DELETE_ON_ERROR:

setup: $(VENV)/.messages

demo: setup
	$(RUN) -m hgma_compensation.demo

# A live stream: node and player as processes, what they do in the terminal until Ctrl-C. LIVE_ARGUMENTS="--seconds 10"
live: setup
	$(RUN) -m hgma_compensation.demo.stream $(LIVE_ARGUMENTS)

# As many processes as cores, each with whole files of tests and a ROS domain of its own. TEST_ARGUMENTS="-n 0 -k watch".
test: lint types
	$(RUN) -m pytest -n auto --maxprocesses 8 --dist loadfile $(TEST_ARGUMENTS)

lint: setup
	$(RUN) -m ruff check .
	$(RUN) -m ruff format --check .

types: setup
	$(RUN) -m mypy hgma_compensation benchmarks

# The error of every method on the measured chamber recording, five seeds.
chamber-table: setup
	$(RUN) -m benchmarks.chamber_table

# The same for settings of the genetic search beside the defaults.
chamber-sensitivity: setup
	$(RUN) -m benchmarks.chamber_table --sensitivity

# The chamber's memories: found in the first cooling and the heating, judged on the last cooling; the README's picture too.
chamber-diagnosis: setup
	$(RUN) -m benchmarks.chamber_diagnosis --picture docs/images/chamber.png --raw-picture docs/images/before_after.png

# Recordings whose effect nobody is told, diagnosed: docs/LOOP.md. Takes hours; LOOP_ARGUMENTS="--count 1" less.
loop-benchmark: setup
	$(RUN) -m benchmarks.loop --output docs/LOOP.md $(LOOP_ARGUMENTS)

# Table 3 of Zhu et al. 2019 on a simulated oven test, with the figures that are defined beside it: docs/PAPER.md.
paper-table: setup
	$(RUN) -m benchmarks.paper_table

# The node under all that a robot does to it, for about an hour and a half: docs/RELIABILITY.md.
# SOAK_ARGUMENTS="kills loops" runs some of it.
soak: setup
	$(RUN) -m benchmarks.soak $(SOAK_ARGUMENTS)

# Speed and memory against rivals, one table, in about 25 minutes on a machine that does nothing else.
# BENCH_ARGUMENTS="messages blocks --json FILE" runs some of it; "--write-docs" puts all of it into docs/PERFORMANCE.md.
bench: setup
	$(RUN) -m benchmarks.bench $(BENCH_ARGUMENTS)

# The pictures of the effects' pages and the tables in them; the chamber's picture is made by chamber-diagnosis.
pictures: setup
	$(RUN) -m benchmarks.pictures

# A fleet of 200 simulated sensors on a Dask cluster, a worker killed on the way, against one machine: docs/FLEET.md.
fleet-benchmark: setup
	$(RUN) -m benchmarks.fleet --sensors 200 --kill-one $(FLEET_ARGUMENTS)

clean:
	rm -rf $(VENV) build dist install log demo_output paper_output *.egg-info .mypy_cache .pytest_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# The three stages of the set-up, each with a stamp written last. While pip changes the environment there is
# a file .busy: where it is found, an interrupted pip has left an unknown state, and all is made anew.
$(VENV)/.created: $(if $(wildcard $(VENV)/.busy),FORCE)
	@$(PYTHON) -c "$$CHECK_PYTHON" || { [ $$? = 3 ] || echo "error: cannot run $(PYTHON): $(NEEDED)" >&2; exit 1; }
	@echo "Setting up $(VENV), which takes about two minutes the first time"
	@$(PYTHON) -m venv --clear $(VENV)
	@touch $@

$(VENV)/.project: $(VENV)/.created setup.py setup.cfg pyproject.toml hgma_compensation/__init__.py
	@touch $(VENV)/.busy
	$(RUN) -m pip install --quiet --editable '.[ros,offline,test]'
	@rm $(VENV)/.busy && touch $@

# Not made anew after each edit of pyproject.toml; setup.py counts because it decides which ROS there is.
$(VENV)/.messages: $(VENV)/.created setup.py $(MESSAGES) | $(VENV)/.project
	@rm -rf $(VENV)/wheels
	$(RUN) -m pip wheel --quiet --no-deps --wheel-dir $(VENV)/wheels ./hgma_msgs
	@touch $(VENV)/.busy
	$(RUN) -m pip install --quiet --no-deps --force-reinstall $(VENV)/wheels/hgma_msgs-*.whl
	@rm $(VENV)/.busy
	@$(RUN) -c "import rclpy, hgma_msgs.msg, hgma_msgs.srv"
	@touch $@

NEEDED := CPython 3.10 or newer with venv is needed (another one: make PYTHON=python3.12)

# Written for any Python, so that an old one can say that it is too old.
define CHECK_PYTHON
import os, platform, sys, sysconfig
def refuse(reason):
    sys.stderr.write("error: %s: %s\n" % (sys.executable, reason))
    sys.exit(3)
if sys.version_info < (3, 10):
    refuse("is Python %d.%d. $(NEEDED)" % sys.version_info[:2])
try:
    import ensurepip, venv
except ImportError:
    refuse("has no venv (Debian and Ubuntu: apt install python3-venv)")
if not os.path.exists(os.path.join(sysconfig.get_path("include"), "Python.h")):
    refuse("has no C headers, which the messages are compiled with (Debian and Ubuntu: apt install python3-dev)")
if sys.version_info >= (3, 14) or platform.machine() != "x86_64":
    sys.stderr.write("note: the wheels of ROS 2 Jazzy were made for CPython 3.10 to 3.13 on x86_64\n")
endef
export CHECK_PYTHON
