# SPDX-License-Identifier: GPL-3.0-or-later
# Shared by ./demo and ./test, which source it. It expects to be run from the project's root.

fail() {
    echo "$script: $*" >&2
    exit 1
}

# missing_packages LIST...: packages of these files that are not installed.
missing_packages() {
    local package
    for package in $(sed 's/#.*//' "$@"); do
        dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || echo "$package"
    done
}

# install_packages LIST...: installs what is missing of these files, as root or with sudo, and says what.
install_packages() {
    local manual="install the packages of $* by other means and use --no-install"
    local missing as_root=()
    command -v dpkg-query >/dev/null && command -v apt-get >/dev/null \
        || fail "this is not a Debian system; $manual."
    missing=$(missing_packages "$@" | tr '\n' ' ')
    [ -n "$missing" ] || return 0
    if [ "$(id -u)" != 0 ]; then
        command -v sudo >/dev/null || fail "there is no sudo; run this as root, or $manual. Missing: $missing"
        as_root=(sudo)
    fi
    echo "Installing ${missing% }."
    local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300)
    "${apt[@]}" update >/dev/null || fail "apt-get update failed; see above, or $manual."
    "${apt[@]}" install -y --no-install-recommends $missing >/dev/null || fail "apt-get could not install $missing; see above."
}

# configure PRESET [CMAKE OPTION...]
configure() {
    local tool log
    for tool in cmake ninja c++; do
        command -v "$tool" >/dev/null || fail "$tool is missing; run ./$script without --no-install."
    done
    log=$(mktemp)
    if ! cmake --preset "$@" >"$log" 2>&1; then
        cat "$log" >&2
        rm -f "$log"
        fail "the build could not be configured; see above (a missing library: run ./$script without --no-install)."
    fi
    rm -f "$log"
}

# build PRESET [TARGET...]
build() {
    local preset=$1
    shift
    cmake --build --preset "$preset" --parallel "${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}" ${1:+--target "$@"} \
        || fail "the build failed; see above."
}
