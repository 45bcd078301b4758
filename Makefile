# Everything runs in .venv, which the first target that needs it makes: `make compare` is all it takes.

PYTHON ?= python3
ARGS ?=

ready := .venv/.ready
bin := .venv/bin

.DEFAULT_GOAL := help
.PHONY: compare study stability validate test mypy pytest test-long test-oldest bench docs clean help

compare: $(ready) ## run every model on every published wall and tabulate, in comparison/
	$(bin)/runningbond compare --out comparison $(ARGS)

study: $(ready) ## measure every model's error against its cost, in study/
	$(bin)/runningbond study --out study $(ARGS)

stability: $(ready) ## drive every method over its edge, and tell where each may be trusted, in stability/
	$(bin)/runningbond stability --out stability $(ARGS)

validate: $(ready) ## predict walls that were broken in laboratories, and score the predictions, in laboratory/
	$(bin)/runningbond validate --out laboratory $(ARGS)

test: $(ready) ## style, types, and the tests that take seconds
	$(bin)/ruff check
	$(bin)/ruff format --check
	@$(MAKE) --no-print-directory -j 2 mypy pytest

mypy: $(ready)
	$(bin)/mypy

pytest: $(ready)
	@# One thread of linear algebra a worker, for there is a worker a core; and bytecode kept for the many processes they start.
	OPENBLAS_NUM_THREADS=1 PYTHONDONTWRITEBYTECODE= $(bin)/pytest -q -n logical --maxprocesses 8 --dist worksteal -m "not long" $(ARGS)

test-long: $(ready) ## the studies that take minutes
	$(bin)/pytest -q -m long $(ARGS)

test-oldest: ## the tests with the oldest version of every library that pyproject.toml takes, in .venv-oldest
	$(PYTHON) -m venv --clear .venv-oldest
	$(PYTHON) tools/oldest_versions.py > .venv-oldest/oldest.txt
	.venv-oldest/bin/python -m pip install -q --disable-pip-version-check -c .venv-oldest/oldest.txt -e '.[develop]'
	@# What is deprecated in an old version is no matter of ours.
	OPENBLAS_NUM_THREADS=1 .venv-oldest/bin/pytest -q -n logical --maxprocesses 8 --dist worksteal -m "not long" \
		-W ignore::DeprecationWarning $(ARGS)

bench: $(ready) ## run the benchmarks one after another
	@set -e; for script in $(sort $(wildcard benchmarks/*.py)); do echo "$$script"; PYTHONPATH=. $(bin)/python "$$script"; done

docs: .venv/.docs ## build the documentation, its gallery run, in site/
	$(bin)/sphinx-build -q -W --keep-going -d build/docs docs site
	@echo 'site/index.html: open it in a browser; nothing is loaded from anywhere.'

.venv/.docs: $(ready)
	@$(bin)/python -m pip install -q --disable-pip-version-check -e '.[docs]'
	@touch $@

clean: ## remove .venv and caches; results stay
	rm -rf .venv .venv-oldest docs/gallery-of-examples .mypy_cache .ruff_cache .pytest_cache .hypothesis build dist *.egg-info
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

help: ## show this
	@awk -F ':.*## ' '/^[a-z-]+:.*## /{printf "make %-12s%s\n", $$1, $$2}' Makefile
	@echo
	@echo 'ARGS="panel-01 --models limit" goes to runningbond compare; PYTHON=python3.12 is the interpreter of a new .venv.'

# The stamp is touched last and taken away first: with none, the setup is new or was broken off, and starts afresh.
$(ready): pyproject.toml Makefile tools/system-libraries
	@$(check-python)
	@tools/system-libraries
	@echo 'Setting up .venv: a few minutes the first time.'
	@test -e $@ || $(PYTHON) -m venv --clear --upgrade-deps .venv
	@rm -f $@
	@# Setuptools warns of every editable installation, and pip passes that on.
	@PYTHONWARNINGS='ignore:Editable installation' \
		$(bin)/python -m pip install -q --disable-pip-version-check --no-compile -e '.[develop]'
	@# On all cores, where pip compiles one file after the other; what cannot be compiled is never imported either.
	@$(bin)/python -m compileall -qq -j 0 -x 'site-packages/.*/tests/' .venv/lib || true
	@touch $@

refuse = { echo "runningbond: $(1)" >&2; exit 1; }
install-python = install Python 3.11 or newer with venv (Debian, Ubuntu: apt-get install python3 python3-venv), \
or name one: make PYTHON=python3.12

# Debian packs ensurepip, without which venv makes nothing useful, separately from Python.
define check-python
command -v $(PYTHON) >/dev/null || $(call refuse,$(PYTHON) not found: $(install-python)); \
$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	|| $(call refuse,$(PYTHON) is too old: $(install-python)); \
$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null \
	|| $(call refuse,$(PYTHON) cannot make virtual environments: $(install-python))
endef
