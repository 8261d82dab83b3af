# A fresh machine needs git, python3 (3.11 or later, with venv), g++ and make; the rest comes from pip.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SOURCES := pyproject.toml CMakeLists.txt $(wildcard src/skyknot/kernel/_native/*)
BUILD_TOOLS = $(shell $(PYTHON) -c "import tomllib; \
	print(*tomllib.load(open('pyproject.toml', 'rb'))['build-system']['requires'])")

.PHONY: demo test bench clean always

demo: $(VENV)/.installed
	$(BIN)/skyknot solve city_hop --out runs/city_hop

test: $(VENV)/.installed-dev
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/pytest -n 2

bench: $(VENV)/.installed
	@set -e; for script in benchmarks/*.py; do echo "== $$script"; $(BIN)/python $$script; done

clean:
	rm -rf $(VENV) build runs dist .pytest_cache .mypy_cache .ruff_cache .hypothesis

$(VENV)/.tools: pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet cmake ninja $(foreach tool,$(BUILD_TOOLS),"$(tool)")
	touch $@

# The install knows the Python files that there were; this list is newer when one came or went.
$(VENV)/.files: $(VENV)/.tools always
	@find src/skyknot -type f -not -name '*.pyc' | sort > $@.now
	@cmp -s $@.now $@ && rm $@.now || mv $@.now $@

# Editable, so that a changed Python source needs no second install; without build isolation, so
# that a changed C++ source recompiles alone.
$(VENV)/.installed: $(VENV)/.tools $(VENV)/.files $(SOURCES)
	@echo "Installing; the first time compiles the kernel, which takes some minutes."
	$(BIN)/python -m pip install --quiet --no-build-isolation --editable .
	touch $@

$(VENV)/.installed-dev: $(VENV)/.installed
	$(BIN)/python -m pip install --quiet --no-build-isolation --editable ".[dev]"
	touch $@
