# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
# make demo | test | fmt | lint | bench | docs | clean. Needs Python >= 3.11, a C++20 compiler and make; everything else goes
# into .venv. Each step leaves a stamp, so that a second run does only what has changed.

SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DELETE_ON_ERROR:
.SUFFIXES:
MAKEFLAGS += --no-print-directory

PYTHON ?= python3
JOBS ?= $(shell getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)
VENV := .venv
BIN := $(VENV)/bin
STAMPS := build/stamps
export PIP_DISABLE_PIP_VERSION_CHECK := 1
export CMAKE_BUILD_PARALLEL_LEVEL := $(JOBS)
export MPLBACKEND := Agg

find = $(shell find $(wildcard $(1)) -type f \( $(2) \) 2>/dev/null | LC_ALL=C sort)
CPP_SOURCES := $(call find,cpp bindings examples/cpp,-name '*.cpp' -o -name '*.hpp')
CPP_UNITS := $(filter cpp/src/%.cpp,$(CPP_SOURCES))
CMAKE_FILES := CMakeLists.txt $(call find,cmake cpp bindings,-name 'CMakeLists.txt' -o -name '*.cmake' -o -name '*.in')
PYTHON_SOURCES := $(call find,python tests benchmarks reference examples,-name '*.py' -o -name '*.pyi')

.PHONY: help
help:
	@sed -n 's/^## //p' Makefile

## setup    make the local environment and build the package in it
.PHONY: setup
setup: $(STAMPS)/package

## demo     track the shipped recording and rough model against refined model
.PHONY: demo
demo: setup
	$(BIN)/fairlead demo

## test     everything that continuous integration runs
.PHONY: test
test: setup check-format lint cpp-test cpp-test-sanitized pytest-opencv4 pytest

## fmt      format all sources
.PHONY: fmt
fmt: $(STAMPS)/environment
	$(BIN)/ruff check --fix --quiet . || true
	$(BIN)/ruff format --quiet .
	$(BIN)/clang-format -i $(CPP_SOURCES)

## lint     ruff, pyright, import rules, clang-tidy
.PHONY: lint
lint: $(STAMPS)/ruff $(STAMPS)/pyright $(STAMPS)/imports $(STAMPS)/clang-tidy

## stubs    write python/fairlead/_core.pyi after a change of the bindings
.PHONY: stubs
stubs: setup
	$(BIN)/python -m nanobind.stubgen --quiet --module fairlead._core --output-file python/fairlead/_core.pyi
	$(BIN)/ruff format --quiet python/fairlead/_core.pyi

## lock     resolve the dependencies anew (needs uv)
.PHONY: lock
lock:
	uv pip compile --quiet --universal --generate-hashes --no-annotate --no-header --python-version 3.11 \
	    --override requirements/override.txt --group dev --output-file requirements/dev.txt pyproject.toml > /dev/null
	echo 'opencv-python-headless>=4.10,<5' | uv pip compile --quiet --universal --generate-hashes --no-annotate --no-header \
	    --no-deps --python-version 3.11 --output-file requirements/opencv4.txt - > /dev/null

## bench    accuracy against the committed baseline, and time against Ceres, GTSAM and scipy
.PHONY: bench
bench: setup
	$(BIN)/python -m benchmarks
	$(BIN)/python -m benchmarks.speed --output runs/speed

## results  every table and figure of docs/results (ONLY="poses gap": some sections; hours without)
RECORDINGS := $(wildcard $(or $(FAIRLEAD_SHARED_DATA),../shared/data))
.PHONY: results
results: setup
	$(BIN)/fairlead demo -o runs/demo
	cp runs/demo/demo.csv docs/results/demo.csv
	$(BIN)/fairlead reproduce $(if $(ONLY),--only $(ONLY)) --cache runs/results/cache --weather runs/weather \
	    $(if $(RECORDINGS),--real $(RECORDINGS)) -o docs/results

## docs     check that every equation that a source names exists, and every link of the pages
.PHONY: docs
docs: setup
	$(BIN)/python -m pytest -q tests/house/test_docs.py tests/house/test_readme.py

## clean    remove everything that make made
.PHONY: clean
clean:
	rm -rf build $(VENV)

# ---- set-up

# The lock names everything but torch, which one of its packages wants: hence --no-deps.
$(STAMPS)/environment: requirements/dev.txt
	@$(PYTHON) -c 'import sys; v = sys.version_info; sys.exit(v < (3, 11) and f"fairlead needs Python 3.11 or newer, got {v[0]}.{v[1]}")'
	@mkdir -p $(STAMPS)
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --no-deps --require-hashes --requirement requirements/dev.txt
	@touch $@

# torch has a build for each kind of processor and accelerator, so it is pinned by version and not by hash.
$(STAMPS)/torch: $(STAMPS)/environment
	$(BIN)/python -m pip install --quiet torch==2.13.0
	@touch $@

$(STAMPS)/package: $(STAMPS)/environment pyproject.toml VERSION $(CMAKE_FILES) $(filter-out cpp/tests/% examples/%,$(CPP_SOURCES))
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m pip install --quiet --no-build-isolation --no-deps --editable .
	@touch $@

# ---- checks of the text

.PHONY: check-format
check-format: $(STAMPS)/format
$(STAMPS)/format: $(STAMPS)/environment pyproject.toml .clang-format $(PYTHON_SOURCES) $(CPP_SOURCES)
	$(BIN)/ruff format --check .
	$(BIN)/clang-format --dry-run --Werror $(CPP_SOURCES)
	@touch $@

$(STAMPS)/ruff: $(STAMPS)/environment pyproject.toml $(PYTHON_SOURCES)
	$(BIN)/ruff check .
	@touch $@

$(STAMPS)/pyright: $(STAMPS)/torch pyproject.toml $(call find,python,-name '*.py' -o -name '*.pyi')
	$(BIN)/pyright --pythonpath $(BIN)/python
	@touch $@

$(STAMPS)/imports: $(STAMPS)/environment pyproject.toml $(call find,python,-name '*.py')
	PYTHONPATH=python $(BIN)/lint-imports --no-logo
	@touch $@

# ---- C++: warnings are errors, asserts are on; once at -O2 and once with the sanitizers

CMAKE = PATH="$(CURDIR)/$(BIN):$$PATH" cmake
CMAKE_TEST = $(CMAKE) -S . -G Ninja -DFAIRLEAD_BUILD_TESTS=ON -DFAIRLEAD_WERROR=ON \
    -DCMAKE_PREFIX_PATH="$$($(BIN)/python -c 'import sysconfig; print(sysconfig.get_path("purelib"))')/cmeel.prefix"

.PHONY: cpp-test
cpp-test: $(STAMPS)/cpp-test
$(STAMPS)/cpp-test: $(STAMPS)/environment VERSION $(CMAKE_FILES) $(CPP_SOURCES)
	$(CMAKE_TEST) -B build/cpp -DCMAKE_CXX_FLAGS_RELEASE=-O2
	$(CMAKE) --build build/cpp
	PATH="$(CURDIR)/$(BIN):$$PATH" ctest --test-dir build/cpp --output-on-failure --no-tests=error
	@touch $@

.PHONY: cpp-test-sanitized
cpp-test-sanitized: $(STAMPS)/cpp-test-sanitized
$(STAMPS)/cpp-test-sanitized: $(STAMPS)/environment VERSION $(CMAKE_FILES) $(CPP_SOURCES)
	$(CMAKE_TEST) -B build/cpp-sanitized -DFAIRLEAD_SANITIZE=ON -DCMAKE_CXX_FLAGS_RELEASE="-O1 -g1"
	$(CMAKE) --build build/cpp-sanitized
	PATH="$(CURDIR)/$(BIN):$$PATH" ctest --test-dir build/cpp-sanitized --output-on-failure --no-tests=error
	@touch $@

# One stamp per translation unit: clang-tidy takes seconds for each.
TIDY_STAMPS := $(CPP_UNITS:%=$(STAMPS)/tidy/%)
$(STAMPS)/clang-tidy: .clang-tidy $(filter cpp/%,$(CPP_SOURCES)) | $(STAMPS)/compile-commands
	$(MAKE) --jobs=$(JOBS) $(TIDY_STAMPS)
	@touch $@
$(TIDY_STAMPS): $(STAMPS)/tidy/%: % .clang-tidy $(filter %.hpp,$(CPP_SOURCES)) | $(STAMPS)/compile-commands
	@mkdir -p $(@D)
	$(BIN)/clang-tidy --quiet -p build/cpp $<
	@touch $@
$(STAMPS)/compile-commands: $(STAMPS)/environment $(CMAKE_FILES)
	$(CMAKE_TEST) -B build/cpp -DCMAKE_CXX_FLAGS_RELEASE=-O2 > /dev/null
	@touch $@

# ---- Python

# Both current major versions of OpenCV: the package runs with either, and they do not answer alike.
OPENCV_TESTS := tests/unit/test_opencv.py tests/unit/test_baselines.py tests/unit/detect tests/real/test_marker_pen_detection.py
.PHONY: pytest-opencv4
pytest-opencv4: setup $(STAMPS)/opencv4
	PYTHONPATH=build/opencv4 $(BIN)/python -m pytest --numprocesses $(JOBS) --dist loadgroup --quiet $(OPENCV_TESTS)
$(STAMPS)/opencv4: $(STAMPS)/environment requirements/opencv4.txt
	rm -rf build/opencv4
	$(BIN)/python -m pip install --quiet --no-deps --require-hashes --target build/opencv4 --requirement requirements/opencv4.txt
	@touch $@

.PHONY: pytest
pytest: setup $(STAMPS)/torch
	$(BIN)/python -m pytest --numprocesses $(JOBS) --dist loadgroup --quiet
