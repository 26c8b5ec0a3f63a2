# Rules: how sources become the library, the program and the tests. Lists and flags: see Makefile.
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
