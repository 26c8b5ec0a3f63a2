#!/usr/bin/env bash
# Sets a machine up to build Corsac. Asks nothing and never touches the system's package sources.
#
#   tools/setup.sh build          compiler and libraries; writes build/packages.mk (flags for make)
#   tools/setup.sh gen            GL and EGL loaders (glad2) and the Unity test framework -> build/gen
#   tools/setup.sh GROUP...       programs for some targets only: window clang lint valgrind
#
# Missing packages are installed by apt on Debian and Ubuntu (by sudo when not root). Elsewhere, or
# when that is not possible, the package names are printed and the exit code is 5.
# Environment: NO_INSTALL=1 only prints what is missing. CORSAC_CACHE=DIR keeps fetched archives
# (default build/cache). UNITY_DIR=DIR takes unity.c, unity.h and unity_internals.h from there.
set -euo pipefail
cd "$(dirname "$0")/.."
cache=${CORSAC_CACHE:-build/cache}
log=build/setup.log
mkdir -p build

say() { echo "setup: $*" >&2; }
fail() { say "$*"; exit 5; }
have() { command -v "$1" >/dev/null 2>&1; }

# One line a need: group, test, Debian package. The test is `cmd:PROGRAM`, `pc:PKG_CONFIG_NAME`,
# `file:GLOB` or `py:MODULE`.
needs() {
    cat <<'NEEDS'
build    cmd:gcc                         gcc
build    file:/usr/include/stdio.h       libc6-dev
build    cmd:make                        make
build    cmd:pkg-config                  pkgconf
build    pc:glfw3                        libglfw3-dev
build    pc:cglm                         libcglm-dev
build    pc:luajit                       libluajit-5.1-dev
build    pc:assimp                       libassimp-dev
build    pc:openal                       libopenal-dev
build    pc:egl                          libegl-dev
build    pc:gl                           libgl-dev
build    pc:stb                          libstb-dev
build    pc:libcjson                     libcjson-dev
build    lib:libEGL_mesa.so.0            libegl-mesa0
build    file:/usr/lib*/*/dri/swrast_dri.so libgl1-mesa-dri
build    file:/etc/ssl/certs/ca-certificates.crt ca-certificates
build    py:ensurepip                    python3-venv
window   cmd:xvfb-run                    xvfb
window   cmd:xauth                       xauth
clang    cmd:clang                       clang
clang    clangrt:                        libclang-rt-dev
lint     cmd:clang-format                clang-format
lint     cmd:luacheck                    lua-check
valgrind cmd:valgrind                    valgrind
NEEDS
}

met() {
    local kind=${1%%:*} what=${1#*:}
    case $kind in
    cmd) have "$what" ;;
    pc) have pkg-config && pkg-config --exists "$what" ;;
    file) compgen -G "$what" >/dev/null ;;
    lib) /sbin/ldconfig -p 2>/dev/null | grep -q "$what" ;;
    py) have python3 && python3 -c "import $what, venv" 2>/dev/null ;;
    clangrt) have clang && compgen -G "$(clang -print-resource-dir)/lib/linux/libclang_rt.asan*" >/dev/null ;;
    esac
}

missing() {
    local group test package wanted=" $* "
    needs | while read -r group test package; do
        [[ $wanted == *" $group "* ]] || continue
        met "$test" || echo "$package"
    done
}

apt_run() {
    local sudo=()
    if [ "$(id -u)" != 0 ]; then
        have sudo && sudo -n true 2>/dev/null || return 1
        sudo=(sudo -n)
    fi
    "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get "$@" >>"$log" 2>&1
}

install_missing() {
    local packages
    packages=$(missing "$@" | sort -u | tr '\n' ' ')
    [ -n "$packages" ] || return 0
    local command="apt-get install -y --no-install-recommends $packages"
    have apt-get || fail "missing; on Debian these packages are called: $packages"
    [ "${NO_INSTALL:-}" != 1 ] || fail "missing packages. Install with: $command"
    say "installing $packages"
    apt_run update && apt_run install -y --no-install-recommends $packages || {
        tail -5 "$log" >&2 || true
        fail "could not install. As root, run: $command"
    }
}

write_packages_mk() {
    local libs=(glfw3 luajit openal libcjson stb)
    {
        echo "# Written by tools/setup.sh; delete to check the machine again."
        echo "PKG_CFLAGS := $(pkg-config --cflags "${libs[@]}" cglm | sed 's/-I/-isystem /g')"
        echo "PKG_LIBS := -Wl,--as-needed $(pkg-config --libs glfw3 openal libcjson) -lstb"
    } >build/packages.mk.part
    mv build/packages.mk.part build/packages.mk
}

venv() {
    [ -x build/venv/bin/python ] && [ -x build/venv/bin/pip ] && return 0
    python3 -m venv build/venv >>"$log" 2>&1 || fail "python3 -m venv failed; see $log"
}

pip() { build/venv/bin/python -m pip --disable-pip-version-check -q "$@" >>"$log" 2>&1; }

GL_EXTENSIONS=GL_KHR_debug,GL_KHR_no_error,GL_KHR_parallel_shader_compile,\
GL_ARB_parallel_shader_compile,GL_ARB_bindless_texture,GL_ARB_indirect_parameters,\
GL_ARB_shader_draw_parameters,GL_ARB_pipeline_statistics_query,GL_EXT_texture_filter_anisotropic,\
GL_ARB_texture_filter_anisotropic,GL_EXT_texture_compression_s3tc,GL_EXT_texture_sRGB,\
GL_ARB_gpu_shader_int64
EGL_EXTENSIONS=EGL_EXT_client_extensions,EGL_EXT_platform_base,EGL_MESA_platform_surfaceless,\
EGL_EXT_platform_device,EGL_EXT_device_base,EGL_EXT_device_enumeration,EGL_EXT_device_query,\
EGL_KHR_platform_gbm,EGL_KHR_platform_x11,EGL_KHR_platform_wayland,EGL_KHR_create_context,\
EGL_KHR_create_context_no_error,EGL_KHR_no_config_context,EGL_KHR_surfaceless_context,\
EGL_KHR_debug,EGL_MESA_query_driver

glad() {
    venv
    mkdir -p "$cache"
    build/venv/bin/python -c 'import glad' 2>/dev/null ||
        pip install --find-links "$cache" glad2==2.0.8 || { tail -5 "$log" >&2; fail "cannot fetch glad2 2.0.8 from PyPI"; }
    local dir=build/gen
    # --reproducible takes the specifications inside the package; without it glad asks the network.
    build/venv/bin/glad --quiet --reproducible --api gl:core=4.5 --extensions "$GL_EXTENSIONS" \
        --out-path "$dir/glad2" c >>"$log" 2>&1
    build/venv/bin/glad --quiet --reproducible --api egl=1.5 --extensions "$EGL_EXTENSIONS" \
        --out-path "$dir/glad2" c --loader >>"$log" 2>&1
    cp -r "$dir/glad2/include/." "$dir/"
    cp "$dir/glad2/src/gl.c" "$dir/glad2/src/egl.c" "$dir/"
    rm -r "$dir/glad2"
}

unity_files="unity.c unity.h unity_internals.h"
unity_hashes="
a89aaeeaebb8a9f8b9379493592c1a8a135ece211d48128752d2c4c49724690a unity.c
2d356dcffe0f8d887ece0ad8d5cd0d388aeef5482800a7b8fea6d415be8bcf1f unity.h
874c2af0bcebead08d0f609f77e2306a735ba55205b7776d937120cb616d4304 unity_internals.h"

mirror() {
    local id codename
    codename=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
    { cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list 2>/dev/null || true; } |
        sed -nE "s/^deb +(\[[^]]*\] +)?([a-z]+:[^ ]+) +$codename +.*main.*/\2/p" | head -1 | grep . && return
    awk -v suite="$codename" 'BEGIN { RS = "" } {
        uri = ""; ok = 0; n = split($0, line, "\n")
        for (i = 1; i <= n; i++) {
            if (line[i] ~ /^URIs:/) { split(line[i], w, " "); uri = w[2] }
            if (line[i] ~ /^Suites:/) { m = split(line[i], w, " "); for (j = 2; j <= m; j++) ok = ok || w[j] == suite }
        }
        if (ok && uri != "") { print uri; exit } }' /etc/apt/sources.list.d/*.sources
}

unity_from_apt() {
    have apt-get || return 1
    local top=$PWD apt=build/apt uri codename key
    uri=$(mirror) || return 1
    codename=$(. /etc/os-release && echo "$VERSION_CODENAME")
    key=$(. /etc/os-release && echo "/usr/share/keyrings/$ID-archive-keyring.gpg")
    mkdir -p "$apt/lists/partial" "$apt/cache" "$cache"
    if [ ! -f "$cache/cjson_1.7.15.orig.tar.gz" ]; then
        [ -f "$key" ] && key="[signed-by=$key] " || key=
        echo "deb-src $key$uri $codename main" >"$apt/source.list"
        local options=(-o "Dir::Etc::sourcelist=$top/$apt/source.list" -o Dir::Etc::sourceparts=-
            -o "Dir::State::lists=$top/$apt/lists" -o "Dir::Cache=$top/$apt/cache" -o Debug::NoLocking=1)
        apt-get "${options[@]}" update >>"$log" 2>&1 || return 1
        (cd "$cache" && apt-get "${options[@]}" source --download-only cjson=1.7.15) >>"$log" 2>&1 ||
        (cd "$cache" && apt-get "${options[@]}" source --download-only cjson) >>"$log" 2>&1 || return 1
        rm -rf "$apt"
    fi
    tar -xzf "$cache"/cjson_1.7.15.orig.tar.gz -C build/gen/unity --strip-components=4 \
        --wildcards '*/tests/unity/src/unity*' || return 1
    (cd build/gen/unity && echo "$unity_hashes" | grep . | sha256sum -c --quiet -) >>"$log" 2>&1
}

unity_from_pypi() {
    venv
    local req=build/unity-requirements.txt tarball
    echo "cryptoauthlib==20260505 --hash=sha256:34ced301cfba7e58b13f6a423d9afa520c0bd28f6ec933ce79bb37c1ca558fc7" >$req
    pip download --find-links "$cache" --no-deps --no-binary :all: --require-hashes -d "$cache" -r $req || return 1
    tarball=$(ls "$cache"/cryptoauthlib-20260505*.tar.gz)
    tar -xzf "$tarball" -C build/gen/unity --wildcards --transform='s|.*/||' '*/third_party/unity/unity*.[ch]' || return 1
    echo "d7a7255e0fc01418a412d01780aa69c10c64fe03eebfce0e8e2be1144c5959c8  build/gen/unity/unity.c" |
        sha256sum -c --quiet - >>"$log" 2>&1
}

unity() {
    mkdir -p build/gen/unity build/gen/examples
    # The headers of Debian's copy include this file of its build unconditionally.
    echo "/* options come from the command line */" >build/gen/examples/unity_config.h
    if [ -n "${UNITY_DIR:-}" ]; then
        local file
        for file in $unity_files; do cp "$UNITY_DIR/$file" build/gen/unity/; done
        return
    fi
    unity_from_apt || unity_from_pypi || { tail -5 "$log" >&2; fail "cannot fetch Unity; set UNITY_DIR to a folder that holds $unity_files"; }
}

case ${1:-build} in
build) install_missing build; write_packages_mk ;;
gen) glad; unity ;;
*) install_missing "$@" ;;
esac
