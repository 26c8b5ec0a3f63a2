# Corsac. `make help` lists the targets; their rules are in tools/build.mk. Everything built or
# fetched lives under build/, results under out/.
#
#   MODE=release|debug|asan|tsan  CC=gcc|clang    products of gcc and release are in build/, those of
#                                                 other pairs in build/$(CC)-$(MODE)/
#   PREFIX=/usr/local  DESTDIR=                   for `make install`
ifeq ($(origin CC),default)
CC := gcc
endif
MODE ?= release
PREFIX ?= /usr/local
TAG := $(notdir $(CC))-$(MODE)
OBJ := build/obj/$(TAG)
OUT := $(if $(filter gcc-release,$(TAG)),build,build/$(TAG))
GEN := build/gen

WARN := -Wall -Wextra -Werror -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wvla
# gcc guesses at truncation, differently at every level of optimisation; cutting is what snprintf is for.
WARN += $(if $(filter gcc%,$(notdir $(CC))),-Wno-format-truncation)
BASE := -std=c17 -D_GNU_SOURCE -ffp-contract=off -fno-math-errno -g -pthread -Iengine -isystem $(GEN)
OPT_release := -O2
OPT_debug := -O1 -DCORE_DEBUG
OPT_asan := -O1 -DCORE_DEBUG -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer
OPT_tsan := -O1 -DCORE_DEBUG -fsanitize=thread
LINK_asan := -fsanitize=address,undefined
LINK_tsan := -fsanitize=thread
ifeq ($(OPT_$(MODE)),)
$(error MODE=$(MODE) is unknown; use release, debug, asan or tsan)
endif
CFLAGS_ALL = $(BASE) $(OPT_$(MODE)) $(WARN) $(CFLAGS)

# Kernels (*.simd.c) are compiled once per instruction set.
SIMD_sse2 := -msse2 -DCORE_SIMD_WIDTH=4
SIMD_avx2 := -mavx2 -DCORE_SIMD_WIDTH=8
SIMD_avx512 := -mavx512f -mavx512dq -mavx512bw -mavx512vl -DCORE_SIMD_WIDTH=16

LIB_SRC := $(filter-out %.simd.c,$(wildcard $(foreach d,core phys gfx anim nav audio asset scene script,engine/$(d)/*.c)))
SIMD_SRC := $(wildcard engine/*/*.simd.c)
APP_SRC := $(wildcard engine/app/*.c)
LIB_OBJ := $(LIB_SRC:%.c=$(OBJ)/%.o) $(OBJ)/gen/gl.o $(OBJ)/gen/egl.o \
    $(foreach s,sse2 avx2 avx512,$(SIMD_SRC:%.simd.c=$(OBJ)/%.$(s).o))
APP_OBJ := $(APP_SRC:%.c=$(OBJ)/%.o)

ifeq ($(MAKELEVEL),0)
MAKEFLAGS += --no-print-directory -j$(shell nproc)
endif
ifneq ($(filter %clean,$(MAKECMDGOALS)),)
.NOTPARALLEL:
endif

include tools/build.mk

##@ Use
.PHONY: help run play bench bench-peers lab
help: ## this list
	@awk -F ':.*## ' '/^##@/ { print "\n" substr($$0, 5) } /^[a-z-]+:.*## / { printf "  make %-12s %s\n", $$1, $$2 }' Makefile

SPHERES := scripts/scenes/spheres.lua --set n=2500
run: all ## 2,500 falling spheres without a window: table, receipt, out/spheres/{metrics.json,frame.png}
	@$(OUT)/corsac run $(SPHERES) --headless --steps 600 --receipt \
	    --metrics out/spheres/metrics.json --shot out/spheres/frame.png
	@echo "Wrote out/spheres/metrics.json and out/spheres/frame.png. 'make play' opens the same scene in a window."

play: all ## the same scene in a window
	@$(OUT)/corsac run $(SPHERES)

bench: all ## ms per step for 500 to 10,000 spheres -> out/bench.json
	@python3 tools/bench.py --corsac $(OUT)/corsac

bench-peers: all ## the same physics scenes on Corsac, Box3D, Bullet, ODE: speed and error from one run
	@tools/setup.sh peers || echo "peers whose packages are missing are skipped"
	@python3 tools/peers/bench.py

lab: all ## speed against accuracy, charted -> out/lab/report.html; LAB=quick: under 5 minutes
	@tools/setup.sh lab
	@$(if $(filter quick,$(LAB)),:,$(MAKE) lab-builds)
	@$(OUT)/corsac lab $(if $(filter quick,$(LAB)),--quick)

# The thesis "speed prevails" needs the engine built with inexact arithmetic, apart from the products.
.PHONY: lab-builds
lab-builds:
	@$(MAKE) OUT=build/lab-o3 OBJ=build/lab-o3/obj CFLAGS="-O3 -Wno-error" build/lab-o3/corsac
	@$(MAKE) OUT=build/lab-ofast OBJ=build/lab-ofast/obj CFLAGS="-Ofast -Wno-error" build/lab-ofast/corsac

##@ Check
.PHONY: test test-long lint fmt docs
test: ## quick tests: unit tests under ASan and UBSan, command line and scene tests
	@tools/setup.sh window || echo "tests that need a window will be skipped"
	@$(MAKE) MODE=release all
	@$(MAKE) MODE=asan tests
	@python3 tests/run.py --cc $(notdir $(CC))

test-long: ## up to 30 minutes more: both compilers, every instruction set, sanitizers on everything
	@tools/setup.sh window || echo "tests that need a window will be skipped"
	@tools/setup.sh clang
	@tools/setup.sh lab
	@$(MAKE) CC=gcc MODE=release all long-tests
	@$(MAKE) CC=clang MODE=release all
	@$(MAKE) CC=gcc MODE=asan all
	@$(MAKE) CC=clang MODE=asan tests
	@$(MAKE) CC=gcc MODE=tsan all tests
	@python3 tests/run.py --long

lint: ## layout, luacheck, file length, include arrows, headers alone as C and C++, links
	@tools/setup.sh lint
	@python3 tools/lint.py

fmt: ## lay out the C sources
	@tools/setup.sh lint
	@git ls-files -co --exclude-standard '*.c' '*.h' | xargs -r clang-format -i

docs: $(OUT)/corsac-apidoc ## docs/api.md, the editor stubs; charts and stability maps of the last full lab run
	@$(OUT)/corsac-apidoc markdown >docs/api.md
	@$(OUT)/corsac-apidoc stubs >scripts/types/corsac.lua
	@python3 tools/lab/publish.py

##@ Keep
.PHONY: install clean distclean
SHARE := $(DESTDIR)$(PREFIX)/share/corsac
install: all ## program, library, headers, scripts and a pkg-config file below $(DESTDIR)$(PREFIX)
	install -d $(DESTDIR)$(PREFIX)/bin $(DESTDIR)$(PREFIX)/lib/pkgconfig $(SHARE)
	install $(OUT)/corsac $(OUT)/corsac-convert $(DESTDIR)$(PREFIX)/bin/
	install -m 644 $(OUT)/libcorsac-convert.so $(DESTDIR)$(PREFIX)/lib/
	install -m 644 $(OUT)/libcorsac.a $(DESTDIR)$(PREFIX)/lib/
	for header in $(PUBLIC_HEADERS:engine/%=%); do \
	    install -Dm 644 engine/$$header $(DESTDIR)$(PREFIX)/include/corsac/$$header || exit; done
	cp -r scripts assets $(SHARE)/
	sed 's|@PREFIX@|$(PREFIX)|' tools/corsac.pc.in > $(DESTDIR)$(PREFIX)/lib/pkgconfig/corsac.pc

clean: ## remove what was compiled; keep what was fetched
	rm -rf build/obj build/tests build/corsac* build/libcorsac* $(wildcard build/*-release build/*-debug build/*-asan build/*-tsan)

distclean: ## remove build/ and out/
	rm -rf build out
