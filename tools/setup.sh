#!/usr/bin/env bash
# Sets a machine up to build Corsac. Asks nothing and never touches the system's package sources.
#
#   tools/setup.sh build       compiler and libraries; writes their flags for make, build/packages.mk
#   tools/setup.sh gen         GL and EGL loaders (glad2), Unity test framework; writes build/gen
#   tools/setup.sh GROUP...    as build, and what only some targets need: window, clang, lint
#
# Missing packages are installed by apt on Debian and Ubuntu, by sudo when not root. Elsewhere, or
# where that is not possible, the names are printed and the exit code is 5.
# Environment
#   NO_INSTALL=1      only print what is missing
#   CORSAC_CACHE=DIR  where fetched archives are kept, default build/cache
#   UNITY_DIR=DIR     take unity.c, unity.h and unity_internals.h from there
set -euo pipefail
cd "$(dirname "$0")/.."
top=$PWD
cache=${CORSAC_CACHE:-$top/build/cache}
log=build/setup.log
mkdir -p build "$cache"

say() { echo "setup: $*" >&2; }
fail() {
    say "$*"
    exit 5
}
fail_with_log() {
    tail -5 "$log" >&2 2>/dev/null || true
    fail "$@"
}
have() { command -v "$1" >/dev/null 2>&1; }
release() { (. /etc/os-release && eval "echo \${$1:-}"); }

# --- Packages ------------------------------------------------------------------------------------

# One need a line: group, test, package. Tests: cmd:PROGRAM, pc:PKG_CONFIG_NAME, file:GLOB,
# clangrt:.
needs="
build cmd:gcc gcc
build file:/usr/include/stdio.h libc6-dev
build cmd:make make
build cmd:pkg-config pkgconf
build pc:glfw3 libglfw3-dev
build pc:cglm libcglm-dev
build pc:luajit libluajit-5.1-dev
build pc:assimp libassimp-dev
build pc:openal libopenal-dev
build pc:egl libegl-dev
build pc:gl libgl-dev
build pc:stb libstb-dev
build pc:libcjson libcjson-dev
build file:/usr/lib*/libEGL_mesa.so.0 libegl-mesa0
build file:/usr/lib*/dri/swrast_dri.so libgl1-mesa-dri
build file:/usr/share/fonts/truetype/dejavu/DejaVuSansMono.ttf fonts-dejavu-core
build file:/etc/ssl/cert*.pem|/etc/ssl/certs/ca-certificates.crt ca-certificates
build venv: python3-venv
lab venv: python3-venv
peers cmd:g++ g++
peers pc:bullet libbullet-dev
peers pc:ode libode-dev
window cmd:xvfb-run xvfb
window cmd:xauth xauth
window file:/usr/lib*/libXtst.so.6 libxtst6
clang cmd:clang clang
clang clangrt: libclang-rt-dev
lint cmd:g++ g++
lint cmd:clang-format clang-format
lint cmd:luacheck lua-check"

# A file that matches one of the globs; libraries also stand in folders named by architecture.
file_exists() {
    local glob
    local IFS='|'
    for glob in $1; do
        compgen -G "$glob" >/dev/null && return
        compgen -G "${glob/\/usr\/lib\*\///usr/lib/*-linux-gnu/}" >/dev/null && return
    done
    return 1
}

met() {
    local kind=${1%%:*} what=${1#*:}
    case $kind in
    cmd) have "$what" ;;
    pc) have pkg-config && pkg-config --exists "$what" ;;
    file) file_exists "$what" ;;
    venv) have python3 && python3 -c "import ensurepip, venv" 2>/dev/null ;;
    clangrt) have clang && file_exists "$(clang -print-resource-dir)/lib/linux/libclang_rt.asan*" ;;
    esac
}

missing() {
    local group test package
    while read -r group test package; do
        [[ " $* " == *" $group "* ]] && ! met "$test" && printf '%s ' "$package"
    done <<<"$needs" || true
}

install_missing() {
    local packages command root=()
    packages=$(missing "$@")
    [ -n "$packages" ] || return 0
    have apt-get || fail "these packages are missing (names as on Debian): $packages"
    command="apt-get install -y --no-install-recommends $packages"
    [ "${NO_INSTALL:-}" != 1 ] || fail "packages are missing; install them with: $command"
    if [ "$(id -u)" != 0 ]; then
        have sudo && sudo -n true 2>/dev/null ||
            fail "packages are missing, and sudo is not here or asks for a password; as root, run: $command"
        root=(sudo -n)
    fi
    say "installing $packages"
    "${root[@]}" env DEBIAN_FRONTEND=noninteractive sh -c "apt-get update && $command" \
        </dev/null >>"$log" 2>&1 || fail_with_log "could not install packages; the log is $log"
    packages=$(missing "$@")
    [ -z "$packages" ] || fail "still missing after the installation: $packages"
}

# Headers of other projects are system headers: their warnings are not ours.
write_packages_mk() {
    cat >build/packages.mk.part <<MK
# Written by tools/setup.sh; delete this file to have the machine checked again.
PKG_CFLAGS := $(pkg-config --cflags glfw3 luajit openal libcjson stb cglm | sed 's/-I/-isystem /g')
PKG_LIBS := -Wl,--as-needed $(pkg-config --libs glfw3 openal libcjson stb)
ASSIMP_CFLAGS := $(pkg-config --cflags assimp | sed 's/-I/-isystem /g')
ASSIMP_LIBS := $(pkg-config --libs assimp)
MK
    mv build/packages.mk.part build/packages.mk
}

# --- Loaders of GL and EGL -----------------------------------------------------------------------

gl_extensions="GL_KHR_debug GL_KHR_no_error GL_KHR_parallel_shader_compile
GL_ARB_parallel_shader_compile GL_ARB_bindless_texture GL_ARB_indirect_parameters
GL_ARB_shader_draw_parameters GL_ARB_pipeline_statistics_query GL_ARB_texture_filter_anisotropic
GL_EXT_texture_filter_anisotropic GL_EXT_texture_compression_s3tc GL_EXT_texture_sRGB
GL_ARB_gpu_shader_int64"
egl_extensions="EGL_EXT_client_extensions EGL_EXT_platform_base EGL_MESA_platform_surfaceless
EGL_EXT_platform_device EGL_EXT_device_base EGL_EXT_device_enumeration EGL_EXT_device_query
EGL_KHR_platform_gbm EGL_KHR_platform_x11 EGL_KHR_platform_wayland EGL_KHR_create_context
EGL_KHR_create_context_no_error EGL_KHR_no_config_context EGL_KHR_surfaceless_context
EGL_KHR_debug EGL_MESA_query_driver"

pip() { build/venv/bin/python -m pip --disable-pip-version-check -q "$@" >>"$log" 2>&1; }

venv() {
    build/venv/bin/python -m pip --version >/dev/null 2>&1 && return
    rm -rf build/venv
    python3 -m venv build/venv >>"$log" 2>&1 || fail_with_log "python3 -m venv failed"
}

# From the archives that are kept; from PyPI when they are not all there.
install_glad() {
    local wheels=(--find-links "$cache" --require-hashes -r tools/requirements.txt)
    build/venv/bin/python -c 'import glad' 2>/dev/null && return
    pip install --no-index "${wheels[@]}" && return
    pip download --only-binary :all: -d "$cache" "${wheels[@]}" && pip install --no-index "${wheels[@]}"
}

# --reproducible takes the specifications that glad carries; without it, it asks the network.
glad() {
    build/venv/bin/python -m glad --quiet --reproducible --out-path build/glad \
        --api "$1" --extensions "$(echo $2 | tr ' ' ,)" c "${@:3}" >>"$log" 2>&1 ||
        fail_with_log "glad could not generate $1"
}

loaders() {
    say "generating the loaders of OpenGL 4.5 core and EGL 1.5"
    venv
    install_glad || fail_with_log "cannot fetch glad2 2.0.8 from PyPI"
    rm -rf build/glad
    glad gl:core=4.5 "$gl_extensions"
    glad egl=1.5 "$egl_extensions" --loader
    mkdir -p build/gen
    cp -r build/glad/include/. build/glad/src/. build/gen/
    rm -r build/glad
}

# --- Unity ---------------------------------------------------------------------------------------

unity_files="unity.c unity.h unity_internals.h"
cjson=cjson_1.7.15.orig.tar.gz

verify() { (cd "$1" && sha256sum -c --quiet - >>"$top/$log" 2>&1); }

verify_unity_243() {
    verify "$1" <<'SUMS'
a89aaeeaebb8a9f8b9379493592c1a8a135ece211d48128752d2c4c49724690a  unity.c
2d356dcffe0f8d887ece0ad8d5cd0d388aeef5482800a7b8fea6d415be8bcf1f  unity.h
874c2af0bcebead08d0f609f77e2306a735ba55205b7776d937120cb616d4304  unity_internals.h
SUMS
}

verify_unity_251() {
    verify "$1" <<'SUMS'
d7a7255e0fc01418a412d01780aa69c10c64fe03eebfce0e8e2be1144c5959c8  unity.c
SUMS
}

# The mirror that this machine uses for its own release, from either format of source lists.
mirror() {
    local suite
    suite=$(release VERSION_CODENAME)
    cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list 2>/dev/null |
        sed -nE "s/^deb +(\[[^]]*\] +)?([a-z]+:[^ ]+) +$suite +(.* )?main( .*)?$/\2/p" | grep -m1 . && return
    cat /etc/apt/sources.list.d/*.sources 2>/dev/null | awk -v suite="$suite" '
        /^URIs:/ { uri = $2 }
        /^Suites:/ { for (i = 2; i <= NF; i++) if ($i == suite) found = 1 }
        /^[ \t]*$/ { uri = ""; found = 0 }
        found && uri != "" { print uri; exit }' | grep .
}

# Debian's source package cjson carries Unity 2.4.3. Own list, own state: needs no root and leaves
# the system as it is.
fetch_cjson() {
    local apt=$top/build/apt uri key options
    have apt-get && uri=$(mirror) || return 1
    key=/usr/share/keyrings/$(release ID)-archive-keyring.gpg
    mkdir -p "$apt/lists/partial" "$apt/cache"
    echo "deb-src $([ -f "$key" ] && echo "[signed-by=$key] ")$uri $(release VERSION_CODENAME)" \
        "main$([ "$(release ID)" = ubuntu ] && echo " universe")" >"$apt/source.list"
    options=(-o Dir::Etc::sourcelist="$apt/source.list" -o Dir::Etc::sourceparts=-
        -o Dir::State::lists="$apt/lists" -o Dir::Cache="$apt/cache" -o Debug::NoLocking=1)
    (cd "$cache" && apt-get "${options[@]}" update &&
        apt-get "${options[@]}" source --download-only cjson) >>"$log" 2>&1 || return 1
    rm -rf "$apt"
    [ -f "$cache/$cjson" ]
}

unity_from_cjson() {
    [ -f "$cache/$cjson" ] || fetch_cjson || return 1
    tar -xzf "$cache/$cjson" -C build/unity --strip-components=4 --wildcards '*/tests/unity/src/unity*' &&
        verify_unity_243 build/unity
}

unity_from_pypi() {
    local package=cryptoauthlib==20260505
    venv
    echo "$package --hash=sha256:34ced301cfba7e58b13f6a423d9afa520c0bd28f6ec933ce79bb37c1ca558fc7" \
        >build/unity/requirements.txt
    pip download --no-deps --no-binary :all: --find-links "$cache" --require-hashes -d "$cache" \
        -r build/unity/requirements.txt || return 1
    tar -xzf "$cache/${package/==/-}.tar.gz" -C build/unity --transform 's|.*/||' \
        --wildcards '*/third_party/unity/unity*.[ch]' && verify_unity_251 build/unity
}

unity() {
    local file
    say "fetching the Unity test framework"
    rm -rf build/unity
    mkdir -p build/unity
    if [ -n "${UNITY_DIR:-}" ]; then
        for file in $unity_files; do
            cp "$UNITY_DIR/$file" build/unity/ || fail "UNITY_DIR=$UNITY_DIR has no $file"
        done
    else
        unity_from_cjson || unity_from_pypi ||
            fail_with_log "cannot fetch Unity; set UNITY_DIR to a folder that holds $unity_files"
    fi
    mkdir -p build/gen/unity build/gen/examples
    for file in $unity_files; do mv "build/unity/$file" build/gen/unity/; done
    rm -r build/unity
    # Debian's copy includes this file of its own build unconditionally.
    echo "/* Unity's options come from the command line. */" >build/gen/examples/unity_config.h
}

# matplotlib and Dask for the lab, pinned; the stamp holds what was asked for.
lab() {
    install_missing lab
    venv
    cmp -s tools/lab/requirements.txt build/venv/lab-requirements.txt && return
    say "fetching what the lab draws and spreads with"
    pip install -r tools/lab/requirements.txt || fail_with_log "cannot fetch the lab's Python packages"
    cp tools/lab/requirements.txt build/venv/lab-requirements.txt
}

case ${1:-build} in
build)
    install_missing build
    write_packages_mk
    ;;
gen)
    loaders
    unity
    ;;
lab) lab ;;
window | clang | lint | peers) install_missing build "$@" ;;
*)
    say "unknown group $1; known: build gen lab window clang lint peers"
    exit 2
    ;;
esac
