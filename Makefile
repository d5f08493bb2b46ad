# Everything here runs in .venv, which the first target makes: Python 3.11+, make and git are enough.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# What `make demo` needs, and what developers need beside it.
DEMO := $(VENV)/.demo
READY := $(VENV)/.ready
# Of ten thousand modules few are imported: these are compiled when they are.
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile
GAUSSMAP := $(BIN)/gaussmap
# Matplotlib's elevation model of the Jacksboro fault: 344 x 403 heights in metres, 3 arc seconds
# apart, rows from north to south. A spline with a cell for every fourth height leaves out what is
# smaller: otherwise each normal has a thousand points.
DEM = from matplotlib.cbook import get_sample_data as f; \
	print(f("jacksboro_fault_dem.npz", asfileobj=False))
TERRAIN = "$$($(BIN)/python -c '$(DEM)'):elevation" --spacing 74.5 -92.5 --cells 100 86

.DEFAULT_GOAL := help
.PHONY: help install demo generate check-generated compiled kernels check-kernels test coverage cad-tests verify bench bench-guard bench-record bench-peers \
	quality operations lint typecheck formulas orders errata figures gallery docs clean

help: ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-16s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

$(DEMO): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
		|| { echo "gaussmap needs Python 3.11 or newer: make PYTHON=python3.12 …" >&2; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(PIP) --editable '.[plot]'
	touch $@

# The package is there already: only what the extra names is installed.
$(READY): $(DEMO)
	$(PIP) 'gaussmap[dev]'
	mkdir -p $(VENV)/typing
	ln -sfn ../.. $(VENV)/typing/gaussmap
	touch $@

install: $(READY) ## make .venv with all that developers need

demo: $(DEMO) ## sample a torus and real terrain by normals: a PLY and a PNG of each in out/
	@mkdir -p out
	$(GAUSSMAP) sample torus --density gauss --count 4000 -o out/torus.ply
	$(GAUSSMAP) plot torus --density gauss --count 4000 -o out/torus.png
	$(GAUSSMAP) sample $(TERRAIN) --density gauss --count 20000 -o out/terrain.ply
	$(GAUSSMAP) plot $(TERRAIN) --density gauss --count 20000 -o out/terrain.png

generate: $(READY) ## derive all formulas and write generated/
	$(BIN)/python -m gaussmap.symbolic

check-generated: $(READY) ## show a diff and fail if generated/ is stale
	$(BIN)/python -m gaussmap.symbolic --check

compiled: $(DEMO) ## compile all kernels into compiled/, as for a wheel, unless they are there
	$(BIN)/python -m gaussmap.runtime.machine_code.building

# What the quick tests compile, from an empty folder.
LISTED := $(CURDIR)/out/kernels
kernels: $(READY) ## list the kernels again that a wheel has (signatures.json, usual.json in runtime/machine_code)
	rm -rf $(LISTED)
	GAUSSMAP_KERNELS=0 NUMBA_CACHE_DIR=$(LISTED) $(MAKE) test
	$(BIN)/python -m gaussmap.runtime.machine_code.listing --write $(LISTED)/kernels-*
	rm -rf $(LISTED)
	$(BIN)/python benchmarks/cold_start.py --usual $(LISTED)
	$(BIN)/python -m gaussmap.runtime.machine_code.listing --usual $(LISTED)/kernels-*

check-kernels: $(READY) ## fail if the tests compiled kernels here that a wheel lacks
	$(BIN)/python -m gaussmap.runtime.machine_code.listing

test: $(READY) compiled ## run the tests, but for those that are slow and seldom fail
	$(BIN)/python -m pytest -q -m "not slow" --numprocesses auto --dist worksteal

coverage: $(READY) ## run kernels and formulas without compilation; fail if few of their lines ran
	NUMBA_DISABLE_JIT=1 $(BIN)/python -m pytest -q -m "kernels and not compiled and not slow" \
		--numprocesses auto --dist worksteal -W ignore::RuntimeWarning \
		--cov --cov-report=term:skip-covered --cov-fail-under=90

# Both versions of Open CASCADE that the extra cad allows; each sees the packages of .venv.
$(VENV)/cad/%/.ready: $(READY)
	$(PYTHON) -m venv --without-pip $(VENV)/cad/$*
	$(BIN)/python -c 'import sysconfig as s; print("import site; site.addsitedir(%r)" % s.get_path("purelib"))' \
		> "$$($(VENV)/cad/$*/bin/python -c 'import sysconfig as s; print(s.get_path("purelib"))')/main.pth"
	$(BIN)/python -m pip --python $(VENV)/cad/$*/bin/python install --quiet --disable-pip-version-check \
		--no-deps 'cadquery-ocp-novtk~=$*'
	touch $@

# What is made of parts that are read: `make verify` tests it with the older version, too.
OF_PARTS := $(addprefix tests/tools/cad/opencascade/,test_meshing.py test_samples.py)
cad-tests: $(VENV)/cad/7.9.3/.ready $(VENV)/cad/8.0.0/.ready ## read CAD files with two versions of Open CASCADE
	$(VENV)/cad/7.9.3/bin/python -m pytest -q -m "not slow" tests/tools/cad/opencascade $(OF_PARTS:%=--ignore=%)
	$(VENV)/cad/8.0.0/bin/python -m pytest -q -m "not slow" tests/tools/cad/opencascade

verify: $(READY) $(VENV)/cad/7.9.3/.ready $(VENV)/cad/8.0.0/.ready ## run what is slow: all tests with many random examples, browsers, products
	$(MAKE) typecheck
	$(BIN)/python -m pytest -q -m slow --hypothesis-profile=large --numprocesses auto --dist worksteal
	$(VENV)/cad/7.9.3/bin/python -m pytest -q $(OF_PARTS)
	$(VENV)/cad/8.0.0/bin/python -m pytest -q -m slow tests/tools/cad/opencascade
	$(BIN)/python -m pytest -q -m "not slow" --hypothesis-profile=large --numprocesses auto --dist worksteal
	$(MAKE) docs
	.ci/check-site
	.ci/check-newcomers
	$(MAKE) coverage bench formulas
	$(MAKE) generate operations errata orders figures
	git diff --exit-code # these write what is committed

bench: $(READY) ## run the benchmarks (ratios against the machine's own limit)
	$(BIN)/python -m pytest benchmarks -o python_files='bench_*.py' --benchmark-only --benchmark-quiet

bench-guard: $(READY) ## fail if sampling is 30 % slower than recorded, beside the writing limit
	$(BIN)/python -m gaussmap.benchmarks.guard

bench-record: $(READY) ## record the ratios that bench-guard compares with
	$(BIN)/python -m gaussmap.benchmarks.guard --record

operations: $(READY) ## record the operation counts of all kernels
	$(BIN)/python tests/generated/test_operations.py

$(VENV)/peers/.ready: $(READY) benchmarks/peers/install
	benchmarks/peers/install

# A smaller number leaves out what takes much time and memory: make bench-peers LARGEST=1e6
LARGEST := 1e8
bench-peers: $(VENV)/peers/.ready ## measure gaussmap beside others, and its scaling, again (docs/performance.md)
	$(VENV)/peers/bin/python -m gaussmap.benchmarks.peers --largest $(LARGEST) > docs/performance.tmp
	mv docs/performance.tmp docs/performance.md

quality: $(VENV)/peers/.ready ## judge samples and meshes beside those of others again (docs/quality.md)
	$(VENV)/peers/bin/python -m gaussmap.benchmarks.quality > docs/quality.tmp
	mv docs/quality.tmp docs/quality.md

lint: $(READY) ## check style, and that imports go one way
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports

# Files and folders; all of them if this is empty: CI checks those of the package, `make verify` all.
TYPED :=
typecheck: $(READY) ## check types
	$(BIN)/pyright $(TYPED)

formulas: $(READY) ## list the formulas; `gaussmap formulas NAME` shows one
	@$(GAUSSMAP) formulas

orders: $(READY) ## measure the orders of approximation again (docs/orders.md)
	$(BIN)/python docs/orders.py > docs/orders.tmp
	mv docs/orders.tmp docs/orders.md

errata: $(READY) ## write the errata of the paper (docs/errata.md)
	$(BIN)/python docs/errata.py > docs/errata.tmp
	mv docs/errata.tmp docs/errata.md

figures: $(READY) demo ## draw the pictures of the README, and Figs. 2-7 of the paper, again (docs/figures.md)
	$(BIN)/python docs/figures.py > docs/figures.tmp
	mv docs/figures.tmp docs/figures.md

gallery: $(READY) ## run the notebooks of docs/gallery/ again
	$(BIN)/python docs/notebooks.py

# The site is built in an environment of its own, which sees the packages of .venv. Its pages call
# the command `gaussmap`.
$(VENV)/docs/.ready: $(READY)
	$(PYTHON) -m venv --without-pip $(VENV)/docs
	$(BIN)/python -c 'import sysconfig as s; print("import site; site.addsitedir(%r)" % s.get_path("purelib"))' \
		> "$$($(VENV)/docs/bin/python -c 'import sysconfig as s; print(s.get_path("purelib"))')/main.pth"
	$(BIN)/python -c 'import tomllib; \
		extras = tomllib.load(open("pyproject.toml", "rb"))["project"]["optional-dependencies"]; \
		print(*(x for x in extras["docs"] if not x.startswith("gaussmap")), sep="\n")' > $(VENV)/docs/packages
	$(BIN)/python -m pip --python $(VENV)/docs/bin/python install --quiet --disable-pip-version-check \
		--requirement $(VENV)/docs/packages
	touch $@

docs: $(VENV)/docs/.ready compiled ## build the site of the documentation, out/site/index.html
	mkdir -p out/extra
	$(GAUSSMAP) view torus --count 2000 --quiet -o out/extra/torus.html
	PATH="$(CURDIR)/$(BIN):$$PATH" $(VENV)/docs/bin/python -m sphinx --quiet --nitpicky --fail-on-warning --keep-going \
		--doctree-dir out/doctrees docs out/site

clean: ## remove what make made
	rm -rf $(VENV) out build *.egg-info .pytest_cache .ruff_cache .hypothesis .benchmarks .coverage
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
