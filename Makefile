# Every chore is one word. `make setup` first; `./vr` needs no make.
SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.PHONY: setup test lint format types docs pins demo clean

UV := $(shell command -v uv || echo .venv/bin/uv)
COMPILE := $(UV) pip compile pyproject.toml --universal --python-version 3.11 \
	--no-header --no-annotate --upgrade --quiet

setup:  ## .venv with the project, the test tools, ruff and pyright
	./vr test --version
	$(UV) pip install --quiet --python .venv/bin/python -r requirements-lint.txt

test:
	./vr test

lint:
	.venv/bin/ruff check
	.venv/bin/ruff format --check

format:
	.venv/bin/ruff check --fix
	.venv/bin/ruff format

types:
	.venv/bin/pyright --pythonpath .venv/bin/python

docs:  ## the manual, in build/manual
	$(UV) pip install --quiet --python .venv/bin/python -r requirements-docs.txt
	.venv/bin/sphinx-build --quiet --fail-on-warning --jobs auto docs build/manual

pins:  ## newest versions that fit together; each file holds only what the one before it lacks
	$(COMPILE) --output-file requirements.txt > /dev/null
	$(COMPILE) --group test -c requirements.txt | grep -vxFf requirements.txt > requirements-test.txt
	$(COMPILE) --group test --group lint -c requirements.txt -c requirements-test.txt \
		| grep -vxFf requirements.txt | grep -vxFf requirements-test.txt > requirements-lint.txt
	$(COMPILE) --group test --group docs -c requirements.txt -c requirements-test.txt \
		| grep -vxFf requirements.txt | grep -vxFf requirements-test.txt > requirements-docs.txt

demo:
	./vr demo

clean:
	rm -rf .venv .pytest_cache .ruff_cache .hypothesis build dist
	find . -name __pycache__ -not -path './.git/*' -prune -exec rm -rf {} +
