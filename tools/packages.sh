# Sourced by the scripts in tools/ and by .ci/run: the Debian and Ubuntu packages that glint needs, and their installation.

glint_build_packages="g++ cmake ninja-build pkg-config libglm-dev libvulkan-dev libvulkan-volk-dev glslang-tools spirv-tools
  mesa-vulkan-drivers libstb-dev libopenexr-dev libjpeg-dev libpng-dev zlib1g-dev libgmp-dev nlohmann-json3-dev libcli11-dev
  libxxhash-dev libwebp-dev libmeshoptimizer-dev libdraco-dev"
glint_window_packages="libglfw3-dev libimgui-dev"
glint_mpi_packages="libopenmpi-dev"
glint_test_packages="python3 python3-numpy python3-pytest libgtest-dev vulkan-validationlayers xvfb xauth xdotool parallel
  $glint_mpi_packages openmpi-bin make fonts-dejavu-core"
glint_docs_packages="python3-sphinx python3-myst-parser furo doxygen python3-numpy"
glint_package_packages="dpkg-dev debhelper dh-python fakeroot lintian xz-utils python3"

step() { echo "== $*"; }

# Prints one sentence and ends the script.
fail() {
    echo "$(basename "$0"): $*" >&2
    exit 1
}

# Ends the script on a release whose packages are too old. Other distributions are left to their users.
check_release() {
    local name oldest=""
    name=$(. /etc/os-release 2>/dev/null && echo "${ID:-} ${VERSION_ID:-}") || return 0
    # Debian's testing and unstable have no number.
    case $name in
        debian\ [0-9]*) oldest="debian 12" ;;
        ubuntu\ [0-9]*) oldest="ubuntu 24.04" ;;
        *) return 0 ;;
    esac
    [ "$(printf '%s\n' "$oldest" "$name" | sort -V | head -n 1)" = "$oldest" ] ||
        fail "$name is too old, as glint needs CMake 3.25 and OpenEXR 3.1: use $oldest or later"
}

# check_disk FOLDER MEBIBYTES
check_disk() {
    local free
    free=$(df -Pk "$1" | awk 'NR == 2 { print int($4 / 1024) }')
    [ "$free" -ge "$2" ] || fail "$1 has $free MiB of free disk space of the $2 MiB needed: free some, or use another disk"
}

# install_missing PACKAGE...
install_missing() {
    local missing="" package log as_root=""
    check_release
    command -v apt-get >/dev/null ||
        fail "there is no apt-get here: install what these Debian packages contain, and build by hand as README.md describes: $*"
    for package in "$@"; do
        dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing="$missing $package"
    done
    [ -n "$missing" ] || return 0
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null || fail "packages are missing and there is no sudo: run as root: apt-get install$missing"
        as_root=sudo
    fi
    check_disk /usr 2500
    step "installing packages:$missing"
    log=$(mktemp)
    # A new machine often updates itself in the background, and holds the lock meanwhile.
    local get="$as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300"
    # The package lists may be missing or too old to install from.
    # shellcheck disable=SC2086
    if ! $get install -y --no-install-recommends $missing >"$log" 2>&1 &&
        ! { $get update && $get install -y --no-install-recommends $missing; } >"$log" 2>&1; then
        fail "packages could not be installed (log: $log): check the network, or install them yourself: apt-get install$missing"
    fi
    rm -f "$log"
}
