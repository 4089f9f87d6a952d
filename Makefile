# Everything sets itself up in .venv: `make demo` and `make test` need Python 3.11 or later and nothing else.
# Another interpreter: make test VENV=.venv-3.13 PYTHON=python3.13, make test-plain PLAIN=.venv-3.13 PYTHON=python3.13.
# Only some of the tests: make test TESTS=tests/cli, make test-plain MARK='not slow'
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
PLAIN ?= .venv-plain
TESTS ?=
MARK ?=
SHARE ?=

.PHONY: demo test test-all test-slow test-plain nightly mutants results check docs showcase man proofs bench bench-roads clean

$(VENV)/.core: pyproject.toml constraints.txt
	$(PYTHON) -c 'import sys; sys.exit("scenic-ref needs Python 3.11 or later" if sys.version_info < (3, 11) else 0)'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e .
	touch $@

$(VENV)/.test: $(VENV)/.core
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[fast,data,geo,cluster,dynamics,sumo,pyro,arviz,play,lsp,test,style]'
	touch $@

$(VENV)/.docs: $(VENV)/.core
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[docs]'
	touch $@

## Scenes of the paper's badly parked car: a picture and JSON Lines in demo/
demo: $(VENV)/.core
	mkdir -p demo
	$(BIN)/scenic-ref run examples/gallery/badly_parked_car.scenic -n 6 --seed 0 -o demo/badly_parked_car.jsonl --plot demo/badly_parked_car.png
	@echo "The scenes are in demo/badly_parked_car.jsonl, their picture is demo/badly_parked_car.png"

## The tests of everything that a change is likely to break: some ten minutes of processor time
test: $(VENV)/.test
	$(BIN)/python -m pytest -n auto --dist worksteal -m "not slow" $(TESTS)

## All tests: also many seeds, what is killed at random moments, all machines that are wrong, big compilations
test-all: $(VENV)/.test
	$(BIN)/python -m pytest -n auto --dist worksteal --seconds $(TESTS)

## The slow tests alone, or a share of them: make test-slow SHARE=0/3
test-slow: $(VENV)/.test
	$(BIN)/python -m pytest -n auto --dist worksteal --seconds -m slow $(if $(SHARE),--share $(SHARE)) $(TESTS)

## All tests without any extra, in an environment of its own: what needs one is skipped, nothing else
test-plain: $(PLAIN)/.test
	$(PLAIN)/bin/python -m pytest -n auto --dist worksteal -m "$(MARK)" $(TESTS)

$(PLAIN)/.test: pyproject.toml constraints.txt
	$(PYTHON) -c 'import sys; sys.exit("scenic-ref needs Python 3.11 or later" if sys.version_info < (3, 11) else 0)'
	$(PYTHON) -m venv $(PLAIN)
	$(PLAIN)/bin/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[test]'
	touch $@

## What the releases say of every vector, anew: some ten minutes; then the differences that are new go to conformance/known_differences.toml
results: $(VENV)/.core
	-$(BIN)/scenic-ref conformance --impl scenic==2.1.0 --seconds 15 --results conformance/results/scenic-2.1.0.json
	-$(BIN)/scenic-ref conformance --impl scenic==3.1.1 --seconds 15 --results conformance/results/scenic-3.1.1.json
	$(BIN)/python docs/pictures.py

## Statistical checks with fresh seeds, which are printed (a failure is a finding, and its seed repeats it); are all tests green without extras? are the vectors for the releases programs of them?
nightly: $(VENV)/.test
	@seed=$$(date +%s); echo "seed $$seed"; \
	$(BIN)/scenic-ref conformance --seed $$seed && SCENIC_REF_SEED=$$seed SCENIC_REF_PROGRAMS=2000 $(BIN)/python -m pytest tests/programs/test_frequencies.py
	$(MAKE) test-plain
	test -x .venv-scenic-3/bin/python || $(PYTHON) -m venv .venv-scenic-3
	.venv-scenic-3/bin/python -m pip install --quiet --disable-pip-version-check scenic==3.1.1
	$(BIN)/python tests/conformance/released.py scenic-3 .venv-scenic-3/bin/python
	$(BIN)/python tests/released/record.py scenic-3 .venv-scenic-3/bin/python --check
	test -x .venv-scenic-2.1/bin/python || $(PYTHON) -m venv .venv-scenic-2.1
	.venv-scenic-2.1/bin/python -m pip install --quiet --disable-pip-version-check 'setuptools<81' wheel
	.venv-scenic-2.1/bin/python -m pip install --quiet --disable-pip-version-check --no-build-isolation scenic==2.1.0
	$(BIN)/python tests/conformance/released.py scenic-2.1 .venv-scenic-2.1/bin/python
	$(BIN)/python tests/released/record.py scenic-2.1 .venv-scenic-2.1/bin/python --check

## Small changes of semantics/, 2000 of them drawn with a fresh seed: which do the vectors notice, which the whole suite? make mutants MUTANTS='-n 200 --vectors-only'
MUTANTS ?= -n 2000
mutants: $(VENV)/.test
	$(BIN)/python -m tests.mutants --jobs $$(nproc) -o mutants.jsonl $(MUTANTS)

## Style, types and layering
check: $(VENV)/.test
	$(BIN)/ruff check .
	$(BIN)/basedpyright
	$(BIN)/python -m pytest tests/test_architecture.py

## The documentation as a site in site/
docs: $(VENV)/.docs
	$(BIN)/python docs/generate.py
	$(BIN)/python docs/textmate.py
	$(BIN)/mkdocs build --strict --quiet
	@! grep -rlE '<(script|link)[^>]*(src|href)="https?://' site --include='*.html' || { echo "these pages need a network"; exit 1; }

## The pictures of the README and the first page of the documentation, docs/images/
showcase: $(VENV)/.core
	$(BIN)/python docs/showcase.py

## The manual page, scenic-ref.1, from the same source as --help; `man ./scenic-ref.1` shows it
man: $(VENV)/.core
	$(BIN)/python docs/manual.py scenic-ref.1

## The theorems of proofs/, checked by Coq 8.16 (Debian: apt-get install coq)
proofs:
	@for tool in coqc coq_makefile; do command -v $$tool > /dev/null || { echo "make proofs needs Coq 8.16, and there is no $$tool (Debian: apt-get install coq)" >&2; exit 1; }; done
	@found=$$(coqc --print-version | cut -d ' ' -f 1); case "$$found" in 8.16.*) ;; *) echo "make proofs needs Coq 8.16, and this is Coq $$found" >&2; exit 1;; esac
	cd proofs && coq_makefile -f _CoqProject -o CoqMakefile && $(MAKE) --no-print-directory -f CoqMakefile -j2
	@echo "Coq accepts the theories. That they leave nothing unproved and assume nothing new is for tests to say: make test TESTS=tests/proofs"

## Scenes per second of each gallery program, by every backend; make bench AGAINST=scenic==3.1.1=/path/to/bin/python measures a released one as well
bench: $(VENV)/.test
	$(BIN)/scenic-ref bench examples/gallery/*.scenic --released benchmarks/released $(if $(AGAINST),--against $(AGAINST)) --prune

## The same on roads: on a map of our own, or on that of MAP=FILE.xodr
bench-roads: $(VENV)/.test
	$(if $(MAP),cp $(MAP) examples/roads/town.xodr,$(BIN)/scenic-ref map --make grid examples/roads/town.xodr)
	cp examples/roads/town.xodr examples/roads/released/town.xodr
	$(BIN)/scenic-ref bench examples/roads/*.scenic --released examples/roads/released $(if $(AGAINST),--against $(AGAINST))

clean:
	rm -rf $(VENV) $(PLAIN) .venv-3.12 .venv-3.13 .venv-scenic-3 .venv-scenic-2.1 demo site build dist *.egg-info
	rm -f scenic-ref.1 proofs/CoqMakefile* proofs/.CoqMakefile.d proofs/*/*.vo* proofs/*/*.glob proofs/*/.*.aux
