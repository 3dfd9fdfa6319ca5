# The few commands a visitor needs. The work itself is done by CMake presets (CMakePresets.json), which .ci/build configures
# when needed and builds, with ccache where it is installed. What is missing is installed, or named, by .ci/set-up.
#
#   make build     set-up, release build: build/release/bin/abbe and the programs that it starts
#   make demo      set-up, build the command alone, run the main study of examples/, say where the report is
#   make closed-loop  measure, identify, compensate, run in LinuxCNC, verify: examples/closed_loop
#   make thermal-day  the same over a day with heat, doors and thermometers: examples/thermal_day
#   make test      set-up, unit and quick tests, those of Python, the most important ones under the sanitizers, short fuzzing
#   make long      the other tests: LinuxCNC, published studies, simulated campaigns, notebooks, most pages, the site
#   make sanitize  all quick tests under the sanitizers
#   make sanitize-libraries  of them, those of the libraries
#   make warnings  GCC's optimised build with its warnings as errors; the development build is clang's
#   make python    set-up, the Python package and its tests
#   make site      set-up, documentation and reference of the Python package as a site: build/site/index.html
#   make unit      build and run the tests of single folders
#   make quick     the same, and the tests of the command and of the pages
#   make lint      formatting, structure and static analysis
#   make format    rewrite the sources in the project's format
#   make bench     speed and accuracy benchmarks
#   make bench-python  speed of the Python package compared with C++, NumPy and other packages
#   make fuzz      fuzz every reader for FUZZ_SECONDS (default 60) each
#   make coverage  line coverage of the quick tests
#   make package   Debian packages and the tarball for any Linux: build/packages
#   make package-test   install both where nothing else is, and test them: root, network, a quarter of an hour
#   make install   install to PREFIX (default /usr/local)
#   make install-linuxcnc   kinematics module into LinuxCNC's folder of modules (linuxcnc/README.md)
#   make clean     remove build/
SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := build
.PHONY: build demo closed-loop thermal-day test long sanitize sanitize-libraries warnings python site unit quick lint format bench bench-python fuzz coverage package package-test install install-linuxcnc clean

PREFIX ?= /usr/local
JOBS ?= $(shell nproc 2>/dev/null || echo 2)
FUZZ_SECONDS ?= 60
TEST_FUZZ_SECONDS ?= 6
DEMO_STUDY ?= examples/aguado/aguado.study.toml
DEMO_RESULTS ?= build/demo
LOOP_RESULTS ?= build/closed-loop
DAY_RESULTS ?= build/thermal-day
# OFF: make test leaves the Python package out, where pip cannot fetch what it needs.
ABBE_PYTHON ?= ON
SET_UP_PYTHON := $(if $(filter ON,$(ABBE_PYTHON)),python)
# OFF: make long leaves the site out, which needs more from pip.
ABBE_SITE ?= $(ABBE_PYTHON)
SET_UP_SITE := $(if $(filter ON,$(ABBE_SITE)),site)
WITH_PYTHON := -DABBE_PYTHON=$(ABBE_PYTHON) $(if $(SET_UP_PYTHON),-DPython_EXECUTABLE=$(CURDIR)/build/python-venv/bin/python)
# Tests that start a LinuxCNC or a browser wait most of the time.
TEST_JOBS ?= $(shell expr 2 \* $(JOBS))
export JOBS
export CTEST_OUTPUT_ON_FAILURE := 1

# What is said at the start: minutes that the whole takes on two cores when nothing is built and nothing is in ccache,
# on a quick machine and on a slow one.
BUILD_MINUTES := 6
DEMO_MINUTES := 5 to 16
LOOP_MINUTES := 3
DAY_MINUTES := 6
TEST_MINUTES := 19 to 50
LONG_MINUTES := 17
SANITIZE_MINUTES := 30
QUICK_MINUTES := 15
PYTHON_MINUTES := 12
SITE_MINUTES := 10

say = @printf '\n== %s (%s)\n' "$(1)" "$$(date -u +%H:%M:%S)"

build:
	@.ci/set-up build
	@.ci/build --expect $(BUILD_MINUTES) "make $@ builds build/release/bin/abbe" release

demo:
	@.ci/set-up build
	@.ci/build --target abbe --expect "$(DEMO_MINUTES)" "make $@ builds the command and runs the main study" release
	build/release/bin/abbe run $(DEMO_STUDY) --output $(DEMO_RESULTS)
	@echo "The report is in $(CURDIR)/$(DEMO_RESULTS)/report.html"

closed-loop:
	@.ci/set-up build linuxcnc
	@.ci/build --expect $(BUILD_MINUTES) "make $@ builds the command before the loop" release
	@echo "The loop takes about $(LOOP_MINUTES) minutes: plan, measure, identify, compensate, run in LinuxCNC, verify"
	examples/closed_loop/run $(LOOP_RESULTS)

# With a kinematics module under a name of its own, so that an installed one is left alone.
thermal-day:
	@.ci/set-up build linuxcnc
	@.ci/build --target abbe --target abbekins_day --expect $(BUILD_MINUTES) "make $@ builds the command before the day" release
	@echo "The day takes about $(DAY_MINUTES) minutes: measure, identify, compensate, run in LinuxCNC, verify"
	examples/thermal_day/run $(DAY_RESULTS)

test:
	@.ci/set-up test $(SET_UP_PYTHON)
	@echo "make $@ checks the format, makes two builds, runs the tests and the fuzzing: from nothing it takes about" \
	  "$(TEST_MINUTES) minutes on 2 cores"
	$(call say,1 of 6: formatting)
	@.ci/format --check
	$(call say,2 of 6: development build with warnings as errors)
	@.ci/build dev -DABBE_WERROR=ON $(WITH_PYTHON)
	$(call say,3 of 6: build with the address and undefined-behaviour sanitizers)
	@.ci/build --target abbe_parts asan -DABBE_WERROR=ON
	$(call say,4 of 6: tests of errors and of the runtime under the sanitizers)
	@ctest --preset asan-parts -j $(JOBS)
	$(call say,5 of 6: fuzzing for $(TEST_FUZZ_SECONDS) s per reader)
	@ABBE_FUZZ_SECONDS=$(TEST_FUZZ_SECONDS) ctest --preset fuzz -j $(JOBS)
	$(call say,6 of 6: tests)
	@ctest --preset dev -j $(TEST_JOBS) -LE 'long|site'
	@echo "All passed. Runs in LinuxCNC, published studies, simulated campaigns, notebooks, most pages and the site are" \
	  "tested by: make long"

long:
	@.ci/set-up test $(SET_UP_PYTHON) $(SET_UP_SITE)
	@.ci/build --target all --target abbe_long_programs --expect $(LONG_MINUTES) "make $@ makes the development build and runs the long tests" \
	  dev -DABBE_WERROR=ON $(WITH_PYTHON)
	@$(if $(SET_UP_SITE),ABBE_SITE_RUNS_NOTEBOOKS=1 )ctest --preset dev -j $(TEST_JOBS) -L 'long|site'

sanitize:
	@.ci/set-up test $(SET_UP_PYTHON)
	@.ci/build --expect $(SANITIZE_MINUTES) "make $@ builds all with the sanitizers and runs the quick tests" asan -DABBE_WERROR=ON \
	  $(WITH_PYTHON)
	@ctest --preset asan -j $(JOBS)

# Without those of make test, and without the programs, which start the same code a thousand times.
sanitize-libraries:
	@.ci/set-up test
	@.ci/build --target abbe_libraries_tests --expect $(SANITIZE_MINUTES) "make $@ builds the libraries with the sanitizers and runs their tests" \
	  asan -DABBE_WERROR=ON
	@ctest --preset asan-libraries -j $(JOBS)

# The release build in a folder of its own, so that the one of make demo keeps its options.
warnings:
	@.ci/set-up build
	@.ci/build --expect $(BUILD_MINUTES) "make $@ builds all with GCC, optimised" gcc -DABBE_WERROR=ON

# In the folder of the development build, configured as by make test.
python:
	@.ci/set-up test python
	@.ci/build --target abbe_python_tests --expect $(PYTHON_MINUTES) "make $@ builds the Python package and runs its tests" dev \
	  -DABBE_WERROR=ON $(WITH_PYTHON)
	@ctest --preset dev -j $(JOBS) -L python

# With the package of the development build, as make python makes it.
site:
	@.ci/set-up test site
	@.ci/build --target abbe_python_stub --expect $(SITE_MINUTES) "make $@ builds the Python package and the pages" dev -DABBE_WERROR=ON \
	  -DABBE_PYTHON=ON -DPython_EXECUTABLE=$(CURDIR)/build/python-venv/bin/python
	@build/python-venv/bin/python docs/site/build_site.py --package build/dev/python --work build/site-work --out build/site

unit:
	@.ci/set-up test
	@.ci/build --expect $(QUICK_MINUTES) "make $@ makes the development build and runs the unit tests" dev -DABBE_WERROR=ON
	@ctest --preset dev -j $(JOBS) -L unit

quick:
	@.ci/set-up test
	@.ci/build --expect $(QUICK_MINUTES) "make $@ makes the development build and runs the quick tests" dev -DABBE_WERROR=ON
	@ctest --preset dev -j $(TEST_JOBS) -L 'unit|quick'

lint:
	@.ci/set-up lint
	@.ci/format --check
	@python3 tests/structure/check_structure.py .
	@python3 tests/structure/check_documents.py .
	@python3 tests/structure/check_headers.py .
	@python3 tests/structure/check_sources.py .
	@.ci/build --configure tidy
	@.ci/lint --jobs $(JOBS)

format:
	@.ci/set-up lint
	@.ci/format

bench:
	@.ci/set-up bench
	@.ci/build bench
	@for program in closest_point compensated_inverse fits forward_pose five_instruments identification identification_memory nc_program planning \
	  polygon_trace program_correction read_csv read_mesh registration roofline runtime_call scan_points \
	  'compensated_inverse --avx2' 'forward_pose --avx2' 'identification --avx2 --quick' 'roofline --avx2'; do \
	  echo "== $$program"; build/bench/bin/$$program; done
	@if [ "$(ABBE_PYTHON)" = ON ] && [ -x build/python-venv/bin/python ]; then $(MAKE) --no-print-directory bench-python; fi

bench-python:
	@.ci/set-up build python
	@.ci/build --target abbe_python_bench --expect $(BUILD_MINUTES) "make $@ builds the Python package" release -DABBE_PYTHON=ON \
	  -DPython_EXECUTABLE=$(CURDIR)/build/python-venv/bin/python
	@venv=build/python-venv; if .ci/bench-venv; then venv=build/bench-venv; fi; \
	  PYTHONPATH=build/release/python $$venv/bin/python benchmarks/python/run.py --json build/bench-python.json

fuzz:
	@.ci/set-up fuzz
	@.ci/build asan
	@ABBE_FUZZ_SECONDS=$(FUZZ_SECONDS) ctest --preset fuzz -j $(JOBS)

coverage:
	@.ci/set-up coverage
	@.ci/build coverage
	@ctest --preset coverage -j $(JOBS)
	@mkdir -p build/coverage/report
	@gcovr --root . --filter src/abbe --exclude '.*_test\.cpp' --html-details build/coverage/report/index.html \
	  --print-summary build/coverage
	@echo "Line by line: build/coverage/report/index.html"

package:
	@.ci/set-up build linuxcnc package
	@.ci/build --expect $(BUILD_MINUTES) "make $@ builds what goes into the packages" release
	@.ci/build --target abbe_static release
	@rm -rf build/packages
	@cpack --config build/release/CPackConfig.cmake -B build/packages
	@rm -rf build/packages/_CPack_Packages
	@cd build/packages && sha256sum *.deb *.tar.gz >SHA256SUMS && ls -sh1

package-test: package
	@.ci/set-up package-test
	@tests/package/run

install: build
	@cmake --install build/release --prefix $(PREFIX)

install-linuxcnc:
	@.ci/set-up build
	@.ci/build --target abbekins release || \
	  { echo "LinuxCNC's headers are missing: apt-get install linuxcnc-uspace-dev" >&2; exit 1; }
	@cmake --install build/release --component linuxcnc

clean:
	rm -rf build
