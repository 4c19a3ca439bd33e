# Every command of the project. `make demo` and `make test` need python >= 3.10 and make, nothing else.

# One BLAS thread per process: two threads on two busy cores make a net 25 times slower.
export OPENBLAS_NUM_THREADS := 1
export MKL_NUM_THREADS := 1
export OMP_NUM_THREADS := 1
# Keep freed memory in the process: handing every large array back to the system costs half the speed.
export MALLOC_MMAP_THRESHOLD_ := 268435456
export MALLOC_TRIM_THRESHOLD_ := 536870912
export MALLOC_TOP_PAD_ := 67108864

PYTHON ?= python3
RUN := .venv/bin/python

SEED ?= 0
NOISE ?= 1
HOUSE ?= 800
ALIASING ?= 0.3
PLAN ?=
ARGS ?=
TABLE ?= $(if $(findstring --quick,$(ARGS)),out/table-quick,out/table)
CHAPTERS ?=
VIEWS := out/data/views-$(NOISE).npz
HOME_PLAN := $(or $(PLAN),out/data/home-$(HOUSE)-$(ALIASING).json)

PYTEST := $(RUN) -m pytest -n auto --dist loadfile --no-loadscope-reorder
LONG := tests/test_demo.py tests/test_table.py tests/test_tutorials.py tests/test_why.py

.PHONY: help demo test test-long lint table tutorials figures bench clean
.DEFAULT_GOAL := help

help:
	@echo "make demo    learn every stage in a home and let a robot find out where it is (out/demo)"
	@echo "             PLAN=path/NAME.json a home of your own (out/demo-NAME)    SEED=0 NOISE=1"
	@echo "             HOUSE=800 another home, from 40 on    ALIASING=0.3 how alike its rooms are, 0..1"
	@echo "             ARGS='--episodes 10000 ...' any option of  $(RUN) -m gnl demo --help"
	@echo "make test    run the tests, but for the long ones"
	@echo "make test-long   run those: demo and tables from end to end, killed and begun again; all chapters, all programs of the results"
	@echo "make lint    check the style of the code"
	@echo "make table   the paper's experiment at full scale, then its report (out/table; half an hour or more)"
	@echo "             ARGS='--quick' a small slice in a minute (out/table-quick); TABLE=folder; more with  $(RUN) -m gnl table --help"
	@echo "make tutorials   run every chapter and render its figures anew; CHAPTERS='04 07' some of them"
	@echo "make bench   our kernels beside the plain or library way, as ratios"
	@echo "make clean   remove .venv and out"

demo: .venv/ready
	@test -n "$(PLAN)" || $(RUN) -m data_gen home "$(HOME_PLAN)" --seed "$(HOUSE)" --aliasing "$(ALIASING)"
	@$(RUN) -m data_gen views "$(VIEWS)" --noise "$(NOISE)"
	@$(RUN) -m gnl demo --plan "$(HOME_PLAN)" --views "$(VIEWS)" --seed "$(SEED)" --noise "$(NOISE)" \
	    --pictures "out/demo$(if $(PLAN),-$$(basename "$(PLAN)" .json))" $(ARGS)

table: .venv/ready
	@$(if $(findstring --out,$(ARGS)),$(error ARGS: expected no --out, found "$(ARGS)"; name the folder with TABLE=))
	@$(RUN) -m gnl table --out "$(TABLE)" $(ARGS)
	@$(RUN) -m gnl report --out "$(TABLE)"

test: .venv/ready
	@$(PYTEST) $(LONG:%=--ignore=%)

test-long: .venv/cluster
	@$(PYTEST) $(LONG)

lint: .venv/ready
	@$(RUN) -m ruff check .

# The chapters draw their figures: to run them is to render them anew.
tutorials figures: .venv/ready
	@$(RUN) tutorials/run.py $(CHAPTERS)

bench: .venv/ready
	@$(RUN) -m tests.bench

clean:
	rm -rf .venv out build *.egg-info

# Made anew only if setup.cfg has changed.
.venv/ready: setup.cfg
	@$(PYTHON) -c 'import sys; v = sys.version_info; v >= (3, 10) or \
	    sys.exit(f"gnl: expected python >= 3.10, found {v[0]}.{v[1]}; name another with make PYTHON=...")'
	@echo "setting up .venv ..."
	@$(PYTHON) -m venv --clear .venv
	@$(RUN) -m pip install --quiet --disable-pip-version-check -e '.[test]'
	@touch $@

# Tests run cells on a cluster of their own.
.venv/cluster: .venv/ready
	@$(RUN) -m pip install --quiet --disable-pip-version-check -e '.[cluster]'
	@touch $@
