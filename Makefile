# Everything runs in .venv, which `make setup` fills from the hashed lock in requirements/.

PYTHON ?= python3
ENGINE ?= $(firstword $(shell command -v podman docker))
VERSION := $(shell sed -n 's/^version = "\(.*\)"/\1/p' pyproject.toml)
SETUP := .venv/.setup
EMBREE := build/embree_ellipsoids
INTEL := build/intel
COMPILE := .venv/bin/uv pip compile --quiet --universal --python-version 3.11 --fork-strategy fewest \
	--generate-hashes --no-emit-index-url --custom-compile-command "make lock"

.PHONY: setup demo test check stress bench bench-farm embree fuzz image load test-api test-chaos test-embree test-farm test-gappa test-intel test-package lock clean

setup: $(SETUP)

$(SETUP): pyproject.toml requirements/dev.txt
	$(PYTHON) -m venv .venv
	.venv/bin/pip install --quiet --only-binary=:all: --require-hashes --requirement requirements/dev.txt
	.venv/bin/pip install --quiet --no-deps --no-build-isolation --editable .
	touch $@

demo: $(SETUP)
	mkdir -p out
	.venv/bin/conicoid render examples/lysozyme.json -o out/lysozyme.exr --preview out/lysozyme.png --verbose

test: $(SETUP)
	.venv/bin/pytest --ignore=tests/api --ignore=tests/chaos --ignore=tests/container --ignore=tests/embree --ignore=tests/farm --ignore=tests/gappa

check: $(SETUP)
	.venv/bin/ruff format --check .
	.venv/bin/ruff check .
	.venv/bin/mypy
	.venv/bin/pytest --quiet tests/test_imports.py

# 20,000 documents, most of them broken, through the parser and the service.
fuzz: $(SETUP)
	.venv/bin/pytest tests/cl/test_document_fuzz.py tests/service/test_fuzz.py --hypothesis-profile=fuzz

stress: $(SETUP)
	.venv/bin/python -m tests.stress

bench: $(SETUP)
	.venv/bin/pip install --quiet --only-binary=:all: --require-hashes --requirement requirements/bench.txt
	.venv/bin/conicoid bench error examples/lysozyme.json --output bench/results
	-$(MAKE) embree
	.venv/bin/conicoid bench speed examples/lysozyme.json --output bench/results --embree $(EMBREE)
	.venv/bin/conicoid bench service examples/lysozyme.json --output bench/results
	.venv/bin/python bench/document.py

# A peer of `conicoid bench speed`, which measures the rest without it; needs Debian's g++ and libembree-dev.
embree: $(EMBREE)

$(EMBREE): bench/embree/ellipsoids.cpp
	mkdir -p $(@D)
	$(CXX) -std=c++17 -O3 -march=native -fno-math-errno -fno-trapping-math -Wall -Wextra -Werror $< -lembree3 -ltbb -o $@

# Throughput of a farm and how it recovers; needs what test-farm needs.
bench-farm: $(SETUP)
	.venv/bin/python bench/farm.py --output bench/results
	.venv/bin/pytest tests/farm/test_kill_matrix.py --results bench/results
	.venv/bin/python bench/document.py

# Twice what the service can do, for ten minutes.
load: $(SETUP) build/load/.setup
	.venv/bin/python bench/load.py --locust build/load/bin/locust --output bench/results

build/load/.setup: requirements/load.txt
	$(PYTHON) -m venv $(@D)
	$(@D)/bin/pip install --quiet --only-binary=:all: --require-hashes --requirement $<
	touch $@

# All in one; `make image-api image-worker` for a farm. Podman keeps health checks in Docker's format only.
image: image-all-in-one

image-%:
	BUILDAH_FORMAT=docker $(ENGINE) build --file docker/Dockerfile --target $* --build-arg VERSION=$(VERSION) \
		--build-arg REVISION=$$(git rev-parse HEAD) --tag $(patsubst conicoid-all-in-one,conicoid,conicoid-$*):$(VERSION) .

test-embree: $(SETUP) $(EMBREE)
	.venv/bin/pytest tests/embree

# Needs Debian's rabbitmq-server, postgresql and iproute2; as root, for networks that can be cut.
test-farm: $(SETUP)
	.venv/bin/pytest tests/farm
	.venv/bin/pytest tests/service/jobs --farm

# Needs Debian's gappa.
test-gappa: $(SETUP)
	.venv/bin/pytest tests/gappa

test-intel: $(SETUP) $(INTEL)/vendors/intel.icd
	OCL_ICD_VENDORS=$(abspath $(INTEL)/vendors) .venv/bin/pytest tests/cl/test_same_everywhere.py -k Intel

# Intel's OpenCL runtime in an environment of its own, and the file that shows it to the loader.
$(INTEL)/vendors/intel.icd: requirements/intel.txt
	$(PYTHON) -m venv $(INTEL)
	$(INTEL)/bin/pip install --quiet --only-binary=:all: --require-hashes --requirement $<
	mkdir -p $(@D)
	echo $(abspath $(INTEL)/lib/libintelocl.so) > $@

test-api: $(SETUP)
	.venv/bin/pytest tests/api

# Needs a kernel that lets users make namespaces, for a disk that can be filled.
test-chaos: $(SETUP)
	.venv/bin/pytest tests/chaos

test-package: $(SETUP)
	.venv/bin/pytest tests/container

lock: $(SETUP)
	$(COMPILE) pyproject.toml --extra farm --extra pocl --extra telemetry --group dev --output-file requirements/dev.txt
	$(COMPILE) pyproject.toml --extra farm --extra telemetry --constraints requirements/dev.txt --output-file requirements/run.txt
	$(COMPILE) pyproject.toml --extra bench --constraints requirements/dev.txt --output-file requirements/bench.txt
	$(COMPILE) --group build --constraints requirements/dev.txt --output-file requirements/build.txt
	$(COMPILE) --group intel --output-file requirements/intel.txt
	$(COMPILE) --group load --output-file requirements/load.txt

clean:
	rm -rf .venv .mypy_cache .pytest_cache .ruff_cache .hypothesis build dist out
