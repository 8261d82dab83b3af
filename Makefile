# A fresh machine needs git, python3 (3.11 or later, with venv), g++ and make; the rest comes from pip.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SOURCES := pyproject.toml CMakeLists.txt $(wildcard src/skyknot/kernel/_native/*)
BUILD_TOOLS = $(shell $(PYTHON) -c "import tomllib; \
	print(*tomllib.load(open('pyproject.toml', 'rb'))['build-system']['requires'])")

.PHONY: demo test docs bench sanitize clean always

demo: $(VENV)/.installed
	$(BIN)/skyknot solve city_hop --out runs/city_hop

test: $(VENV)/.installed-dev
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/pytest -n 2

docs: $(VENV)/.installed
	$(BIN)/python -m pip install --quiet --no-build-isolation --editable ".[docs]"
	$(BIN)/mkdocs build
	@echo "Look at build/site/index.html"

bench: $(VENV)/.installed
	@set -e; for script in benchmarks/*.py; do echo "== $$script"; $(BIN)/python $$script; done

# The kernel compiled with sanitizers, under the tests that need no other solver: a solver that
# CasADi loads with RTLD_DEEPBIND does not get along with them.
SANITIZED := build/sanitized
LEVEL := $(if $(filter x86_64 amd64,$(shell uname -m)),v3,base)
sanitize: $(VENV)/.installed-dev
	$(BIN)/cmake -S . -B $(SANITIZED) -G Ninja -DSKYKNOT_SANITIZE=ON \
		-DCMAKE_MAKE_PROGRAM=$(CURDIR)/$(BIN)/ninja -DPython_EXECUTABLE=$(CURDIR)/$(BIN)/python
	$(BIN)/cmake --build $(SANITIZED)
	PYTHONPATH=tests SKYKNOT_ISA=$(LEVEL) ASAN_OPTIONS=detect_leaks=0 \
		SKYKNOT_SANITIZED=$$(ls $(SANITIZED)/_native_$(LEVEL).*so) \
		LD_PRELOAD="$$($(CXX) -print-file-name=libasan.so) $$($(CXX) -print-file-name=libubsan.so)" \
		$(BIN)/python -m pytest -p kernel.sanitized -p no:cacheprovider \
		tests/kernel/test_faults.py tests/kernel/test_feedback_gains.py \
		tests/kernel/test_micro_program.py tests/kernel/test_newton_against_dense.py \
		tests/contract/test_solve_many.py -k "not any_solver and not keyboard"

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
