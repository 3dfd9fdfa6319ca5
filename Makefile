# The few commands a visitor needs. The work itself is done by CMake presets (CMakePresets.json).
#
#   make build     release build: build/release/bin/abbe
#   make demo      set-up, build, run the main study of examples/, say where the report is
#   make closed-loop  measure, identify, compensate, run in LinuxCNC, verify: examples/closed_loop
#   make test      set-up and every check that continuous integration runs
#   make quick     build and run only the quick tests
#   make lint      formatting, structure and static analysis
#   make format    rewrite the sources in the project's format
#   make bench     speed and accuracy benchmarks
#   make fuzz      fuzz every reader for FUZZ_SECONDS (default 60) each
#   make coverage  line coverage of the quick tests
#   make install   install to PREFIX (default /usr/local)
#   make install-linuxcnc   kinematics module into LinuxCNC's folder of modules (linuxcnc/README.md)
#   make clean     remove build/
SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := build
.PHONY: build demo closed-loop test quick lint format bench fuzz coverage install install-linuxcnc clean

PREFIX ?= /usr/local
JOBS ?= $(shell nproc)
FUZZ_SECONDS ?= 60
DEMO_STUDY ?= examples/aguado/aguado.study.toml
DEMO_RESULTS ?= build/demo
LOOP_RESULTS ?= build/closed-loop

# Objects are shared between build folders and clones where ccache is installed.
export CCACHE_BASEDIR ?= $(CURDIR)
export CCACHE_NOHASHDIR ?= 1
export CTEST_OUTPUT_ON_FAILURE := 1
LAUNCHER = $(if $(shell command -v ccache),-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)

say = @printf '\n== %s (%s)\n' "$(1)" "$$(date -u +%H:%M:%S)"
# $(call build_preset,PRESET[,extra CMake arguments])
define build_preset
@cmake --preset $(1) $(LAUNCHER) $(2) --log-level=WARNING >/dev/null
@cmake --build build/$(1) -j $(JOBS)
endef

build:
	@.ci/set-up build
	$(call build_preset,release)

demo: build
	build/release/bin/abbe run $(DEMO_STUDY) --output $(DEMO_RESULTS)
	@echo "The report is in $(CURDIR)/$(DEMO_RESULTS)/report.html"

closed-loop:
	@.ci/set-up build linuxcnc
	$(call build_preset,release)
	examples/closed_loop/run $(LOOP_RESULTS)

test:
	@.ci/set-up test
	$(call say,Formatting)
	@.ci/format --check
	$(call say,Build with warnings as errors)
	$(call build_preset,dev,-DABBE_WERROR=ON)
	$(call say,Unit tests under the address and undefined-behaviour sanitizers)
	$(call build_preset,asan,-DABBE_WERROR=ON)
	@ctest --preset asan -j $(JOBS)
	$(call say,Fuzzing for $(FUZZ_SECONDS) s per reader)
	$(call build_preset,fuzz,-DABBE_WERROR=ON -DABBE_FUZZ_SECONDS=$(FUZZ_SECONDS))
	@ctest --preset fuzz -j $(JOBS)
	$(call say,All tests)
	@ctest --preset dev -j $(JOBS)

quick:
	@.ci/set-up test
	$(call build_preset,dev,-DABBE_WERROR=ON)
	@ctest --preset dev -j $(JOBS) -L quick

lint:
	@.ci/set-up lint
	@.ci/format --check
	@python3 tests/structure/check_structure.py .
	@cmake --preset tidy $(LAUNCHER) --log-level=WARNING >/dev/null
	@.ci/lint --jobs $(JOBS)

format:
	@.ci/set-up lint
	@.ci/format

bench:
	@.ci/set-up bench
	$(call build_preset,bench)
	@for program in closest_point compensated_inverse fits forward_pose five_instruments identification identification_memory nc_program planning \
	  polygon_trace program_correction read_csv read_mesh registration runtime_call scan_points; do \
	  echo "== $$program"; build/bench/bin/$$program; done

fuzz:
	@.ci/set-up fuzz
	$(call build_preset,fuzz,-DABBE_FUZZ_SECONDS=$(FUZZ_SECONDS))
	@ctest --preset fuzz -j $(JOBS)

coverage:
	@.ci/set-up coverage
	$(call build_preset,coverage)
	@ctest --preset coverage -j $(JOBS)
	@mkdir -p build/coverage/report
	@gcovr --root . --filter src/abbe --exclude '.*_test\.cpp' --html-details build/coverage/report/index.html \
	  --print-summary build/coverage
	@echo "Line by line: build/coverage/report/index.html"

install: build
	@cmake --install build/release --prefix $(PREFIX)

install-linuxcnc:
	@.ci/set-up build
	@cmake --preset release $(LAUNCHER) --log-level=WARNING >/dev/null
	@cmake --build build/release -j $(JOBS) --target abbekins || \
	  { echo "LinuxCNC's headers are missing: apt-get install linuxcnc-uspace-dev" >&2; exit 1; }
	@cmake --install build/release --component linuxcnc

clean:
	rm -rf build
