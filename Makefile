# cgcontact: everything a user or a developer types. Settings: BACKEND=serial (default) or openmp.
#
#   make            install what is missing and build
#   make demo       run the paper's scene and say where its pictures are
#   make test       build and run all tests
#   make trilinos-openmp   build Trilinos with OpenMP into ~/.cache/cgcontact, for BACKEND=openmp (once; half an hour)
#   make asan       the same with address and undefined-behaviour sanitizers
#   make tsan       BACKEND=openmp with the thread sanitizer (clang; needs make trilinos-openmp)
#   make fuzz       RUNS (100000) executions of each fuzz target with libFuzzer and sanitizers
#   make python         build the Python module and say how to use it
#   make wheel          build a wheel of the Python module for this machine, dist/cgcontact-*.whl
#   make install PREFIX=DIR   program, library and documents into DIR (default /usr/local)
#   make docs       reference of the library in build/docs/html (needs doxygen, which it installs)
#   make format     format the sources; format-check, tidy: complain only
#   make clean      remove what these commands built

BACKEND ?= serial
ifeq ($(filter $(BACKEND),serial openmp asan tsan),)
  $(error BACKEND=$(BACKEND): expected serial or openmp)
endif
RUNS ?= 100000
SCENE ?= scenes/two_solids.toml
PREFIX ?= /usr/local
OUT ?= out/$(basename $(notdir $(SCENE)))
CLANG_FORMAT ?= clang-format-14
CLANG_TIDY ?= clang-tidy-14

build := build/$(BACKEND)
folders := core kernels recovery contact python perf tests
sources = $(shell find $(folders) -name '*.[ch]pp')

.NOTPARALLEL:
.PHONY: all build configure demo test python wheel trilinos-openmp asan tsan fuzz install docs format format-check tidy clean \
  deps deps-test deps-docs deps-format deps-tidy deps-wheel
all: build

deps:
	@scripts/install_dependencies.sh
deps-test:
	@scripts/install_dependencies.sh --test
deps-docs:
	@scripts/install_dependencies.sh --docs
deps-tidy:
	@scripts/install_dependencies.sh --tidy
deps-format:
	@scripts/install_dependencies.sh --format
deps-wheel:
	@scripts/install_dependencies.sh --wheel

configure: deps
	@cmake --preset $(BACKEND) --log-level=WARNING

build: configure
	@cmake --build --preset $(BACKEND)

demo: configure
	@cmake --build --preset $(BACKEND) --target cgcontact
	$(build)/cgcontact run $(SCENE) --out $(OUT)
	@echo "The pictures:"
	@ls -1 $(OUT)/*.svg $(OUT)/*.png 2>/dev/null | sed 's/^/  /'
	@ls -1 $(OUT)/*.vtkhdf $(OUT)/*.vtu 2>/dev/null | sed 's/^/  /; s/$$/   (for ParaView)/'

test: deps-test build
	@ctest --preset $(BACKEND)

python: configure
	@cmake --build --preset $(BACKEND) --target cgcontact_python
	@echo "PYTHONPATH=$(CURDIR)/$(build)/python python3 -c 'import cgcontact'    (docs/python.md)"

wheel: deps-wheel configure
	@cmake --build --preset $(BACKEND) --target wheel

trilinos-openmp:
	@scripts/build_trilinos_openmp.sh

asan:
	@$(MAKE) --no-print-directory test BACKEND=asan
tsan:
	@scripts/install_dependencies.sh --tsan
	@$(MAKE) --no-print-directory test BACKEND=tsan

fuzz: deps
	@scripts/install_dependencies.sh --fuzz
	@cmake --preset fuzz --log-level=WARNING
	@cmake --build --preset fuzz
	@for target in scene triangles step; do \
	  limits="-max_len=4096 -timeout=20"; [ $$target = step ] && limits="-max_len=16384 -timeout=60"; \
	  mkdir -p build/fuzz/found_$$target && \
	  build/fuzz/tests/fuzz/fuzz_$$target -runs=$(RUNS) $$limits -rss_limit_mb=2048 -malloc_limit_mb=512 \
	    -artifact_prefix=build/fuzz/$$target- build/fuzz/found_$$target tests/fuzz/seeds/$$target || exit 1; \
	done

install: build
	@cmake --install $(build) --prefix $(PREFIX)

# Warnings of doxygen are errors.
docs: deps-docs
	@rm -rf build/docs && mkdir -p build/docs
	@doxygen docs/Doxyfile 2>build/docs/warnings || { cat build/docs/warnings; exit 1; }
	@if [ -s build/docs/warnings ]; then cat build/docs/warnings; exit 1; fi
	@echo "build/docs/html/index.html"

format: deps-format
	@$(CLANG_FORMAT) -i $(sources)
format-check: deps-format
	@$(CLANG_FORMAT) --dry-run -Werror $(sources)

# clang-tidy cannot read g++'s precompiled headers. It looks at the joined files of a unity build: a tenth of the headers.
tidy: deps-tidy configure
	@cmake --preset $(BACKEND) -B build/tidy -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DCMAKE_UNITY_BUILD=ON \
	  -DCMAKE_EXPORT_COMPILE_COMMANDS=ON --log-level=WARNING
	@cmake --build build/tidy --target view_assets.cpp >/dev/null
	@grep -o '"file": "[^"]*"' build/tidy/compile_commands.json | cut -d'"' -f4 | grep -v '/tests/\|/perf/' | \
	  xargs -n1 -P$(shell nproc) $(CLANG_TIDY) -p build/tidy --quiet --extra-arg=-Qunused-arguments \
	  --extra-arg=-Wno-unknown-warning-option 2>/dev/null

clean:
	rm -rf build/serial build/openmp build/asan build/tsan build/fuzz build/tidy build/docs out dist
