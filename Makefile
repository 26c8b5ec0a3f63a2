# Corsac. `make help` lists the targets. Everything built or
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

.DEFAULT_GOAL := all
.DELETE_ON_ERROR:
.SUFFIXES:

# The machine is set up once: packages (their flags land in build/packages.mk) and generated
# sources. A stamp's name changes when its recipe does, so copied or cached trees stay valid.
NEEDS_BUILD := $(filter-out clean distclean help fmt lint,$(or $(MAKECMDGOALS),all))
GEN_READY := $(GEN)/ready-1
ifneq ($(NEEDS_BUILD),)
include build/packages.mk
endif
build/packages.mk: tools/setup.sh
	@tools/setup.sh build
$(GEN_READY): | build/packages.mk
	@tools/setup.sh gen
	@touch $@

# Names of C library functions that LuaJIT must reach through the engine (`-Wl,--wrap=NAME`), set by
# WRAP := pow sin ... in that file.
-include engine/script/wrap.mk
WRAP_FLAGS := $(WRAP:%=-Wl,--wrap=%)
LIBS = -l:libluajit-5.1.a $(PKG_LIBS) -lm -ldl -lpthread

# Objects depend on the flags they were made with, archives and programs on what they are made of.
define remember
$1: FORCE | build/packages.mk
	@mkdir -p $$(@D); echo '$2' | cmp -s - $$@ || echo '$2' >$$@
endef
$(eval $(call remember,$(OBJ)/flags,$(CC) $$(CFLAGS_ALL) $(PKG_CFLAGS)))
$(eval $(call remember,$(OBJ)/members,$(LIB_OBJ)))
$(eval $(call remember,$(OBJ)/link,$(APP_OBJ) $(LIBS) $(LINK_$(MODE)) $(WRAP_FLAGS) $(LDFLAGS)))
.PHONY: FORCE
COMPILE = @mkdir -p $(@D); echo "  CC    $@"; $(CC) $(CFLAGS_ALL) $(PKG_CFLAGS) -MMD -MP
LINK = @mkdir -p $(@D); echo "  LINK  $@"; $(CC) $(LINK_$(MODE)) -pthread $(LDFLAGS)

# What C users may include: one header a room, and those of core that stand alone.
PUBLIC_HEADERS := $(foreach room,phys gfx anim nav audio asset scene script,$(wildcard engine/$(room)/$(room).h)) \
    $(filter-out engine/core/simd_% %_internal.h,$(wildcard engine/core/*.h))

.PHONY: all
all: $(OUT)/libcorsac.a $(if $(APP_SRC),$(OUT)/corsac) $(OUT)/corsac-convert $(OUT)/libcorsac-convert.so

$(OBJ)/%.o: %.c $(OBJ)/flags | $(GEN_READY)
	$(COMPILE) -c -o $@ $<
$(OBJ)/%.sse2.o: %.simd.c $(OBJ)/flags | $(GEN_READY)
	$(COMPILE) $(SIMD_sse2) -c -o $@ $<
$(OBJ)/%.avx2.o: %.simd.c $(OBJ)/flags | $(GEN_READY)
	$(COMPILE) $(SIMD_avx2) -c -o $@ $<
$(OBJ)/%.avx512.o: %.simd.c $(OBJ)/flags | $(GEN_READY)
	$(COMPILE) $(SIMD_avx512) -c -o $@ $<
# Generated and fetched sources are not ours to warn about.
$(OBJ)/gen/%.o: $(OBJ)/flags | $(GEN_READY)
	$(COMPILE) -w -c -o $@ $(GEN)/$*.c

$(OUT)/libcorsac.a: $(LIB_OBJ) $(OBJ)/members
	@mkdir -p $(@D); echo "  AR    $@"; rm -f $@; $(AR) rcs $@ $(LIB_OBJ)
$(OUT)/corsac: $(APP_OBJ) $(OUT)/libcorsac.a $(OBJ)/link
	$(LINK) $(WRAP_FLAGS) -o $@ $(APP_OBJ) $(OUT)/libcorsac.a $(LIBS)

# The converter: a program and a library that the engine loads at run time. Both are made of the
# converter and the two rooms it needs, position-independent and with only its one function visible.
CONVERT_SRC := $(filter-out tools/convert/main.c,$(wildcard tools/convert/*.c)) engine/anim/pack.c engine/anim/pack_encode.c $(wildcard engine/asset/*.c engine/core/*.c)
CONVERT_OBJ := $(CONVERT_SRC:%.c=$(OBJ)/pic/%.o)
CONVERT_MAIN := $(OBJ)/pic/tools/convert/main.o
CONVERT_LIBS := -Wl,--as-needed $(ASSIMP_LIBS) -lcjson -lstb -lm -lpthread
$(OBJ)/pic/%.o: %.c $(OBJ)/flags | $(GEN_READY)
	$(COMPILE) $(ASSIMP_CFLAGS) -fPIC -fvisibility=hidden -c -o $@ $<
$(OUT)/corsac-convert: $(CONVERT_OBJ) $(CONVERT_MAIN) $(OBJ)/link
	$(LINK) -o $@ $(CONVERT_OBJ) $(CONVERT_MAIN) $(CONVERT_LIBS)
$(OUT)/libcorsac-convert.so: $(CONVERT_OBJ) $(OBJ)/link
	$(LINK) -shared -o $@ $(CONVERT_OBJ) $(CONVERT_LIBS)

# Test programs: tests/ROOM/test_NAME.c -> $(OUT)/tests/ROOM/test_NAME, with the references of
# tests/ref and the helpers of tests/support. Only programs of the rooms that run Lua wrap the C
# library: the others compare with the true one.
TEST_SRC := $(wildcard tests/*/test_*.c)
LONG_SRC := $(wildcard tests/long/*/test_*.c)
TEST_BIN := $(TEST_SRC:%.c=$(OUT)/%)
LONG_BIN := $(LONG_SRC:%.c=$(OUT)/%)
TEST_AID := $(patsubst %.c,$(OBJ)/%.o,$(filter-out %.simd.c,$(wildcard tests/ref/*.c tests/support/*.c))) \
    $(foreach s,sse2 avx2 avx512,$(patsubst %.simd.c,$(OBJ)/%.$(s).o,$(wildcard tests/support/*.simd.c))) \
    $(OBJ)/gen/unity/unity.o
TEST_ROOMS := $(sort $(foreach f,$(TEST_SRC),$(word 2,$(subst /, ,$f))))
LUA_ROOMS := script scene app
$(TEST_BIN) $(LONG_BIN): $(OUT)/%: $(OBJ)/%.o $(TEST_AID) $(OUT)/libcorsac.a $(OBJ)/link
	$(LINK) $(if $(filter $(LUA_ROOMS),$(notdir $(@D))),$(WRAP_FLAGS)) -o $@ $< $(TEST_AID) $(OUT)/libcorsac.a $(LIBS)
$(OBJ)/tests/%.o $(OBJ)/gen/unity/%.o: BASE += -Itests -isystem $(GEN)/unity -DUNITY_INCLUDE_DOUBLE -DUNITY_SUPPORT_64

.PHONY: tests long-tests $(TEST_ROOMS:%=check-%)
tests: $(TEST_BIN)
long-tests: $(LONG_BIN)
define check_room
check-$1: $(filter $(OUT)/tests/$1/%,$(TEST_BIN))
	@rc=0; for t in $$^; do echo "$$$$t"; "$$$$t" || rc=1; done; exit $$$$rc
endef
$(foreach room,$(TEST_ROOMS),$(eval $(call check_room,$(room))))
check-%:
	@test -d engine/$* && echo "no tests/$*/test_*.c yet"

-include $(CONVERT_OBJ:.o=.d) $(CONVERT_MAIN:.o=.d) $(LIB_OBJ:.o=.d) $(APP_OBJ:.o=.d) $(TEST_AID:.o=.d) $(TEST_SRC:%.c=$(OBJ)/%.d) $(LONG_SRC:%.c=$(OBJ)/%.d)

##@ Use
.PHONY: help run play bench bench-peers lab
help: ## this list
	@awk -F ':.*## ' '/^##@/ { print "\n" substr($$0, 5) } /^[a-z-]+:.*## / { printf "  make %-12s %s\n", $$1, $$2 }' Makefile

SPHERES := scripts/scenes/spheres.lua --set n=2500
run: all ## 2,500 falling spheres without a window: table, receipt, out/spheres/{metrics.json,frame.png}
	@$(OUT)/corsac run $(SPHERES) --headless --steps 600 --receipt \
	    --metrics out/spheres/metrics.json --shot out/spheres/frame.png
	@echo "Wrote out/spheres/metrics.json and out/spheres/frame.png. 'build/corsac run $(SPHERES)' opens the same scene in a window."

play: all ## the game: a fox, a walled garden, two minutes
	@$(OUT)/corsac run scripts/game

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
