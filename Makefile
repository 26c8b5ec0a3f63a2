# Corsac. `make help` lists the targets. Everything built or fetched lives under build/, results under
# out/. MODE=release|debug|asan|tsan, CC=gcc|clang; products of the default pair are in build/, those
# of others in build/$(CC)-$(MODE)/.
ifeq ($(origin CC),default)
CC := gcc
endif
MODE ?= release
TAG := $(notdir $(CC))-$(MODE)
OBJ := build/obj/$(TAG)
OUT := $(if $(filter gcc-release,$(TAG)),build,build/$(TAG))
GEN := build/gen

WARN := -Wall -Wextra -Werror -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wvla
BASE := -std=c17 -D_GNU_SOURCE -ffp-contract=off -fno-math-errno -g -pthread -Iengine -isystem $(GEN)
OPT_release := -O2
OPT_debug := -O1 -DCORE_DEBUG
OPT_asan := -O1 -DCORE_DEBUG -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer
OPT_tsan := -O1 -DCORE_DEBUG -fsanitize=thread
LINK_asan := -fsanitize=address,undefined
LINK_tsan := -fsanitize=thread
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

include tools/build.mk
