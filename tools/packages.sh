# Sourced by tools/demo, tools/test and tools/package: installs the Debian packages that are missing, and says so.

glint_build_packages="g++ cmake ninja-build pkg-config libglm-dev libvulkan-dev libvulkan-volk-dev glslang-tools spirv-tools
  mesa-vulkan-drivers libstb-dev libopenexr-dev libjpeg62-turbo-dev libpng-dev zlib1g-dev libgmp-dev nlohmann-json3-dev libcli11-dev libxxhash-dev"
glint_window_packages="libglfw3-dev libimgui-dev"
glint_mpi_packages="libopenmpi-dev"
glint_test_packages="python3 libgtest-dev vulkan-validationlayers clang-format-14 clang python3-numpy python3-pytest xvfb xauth xdotool parallel libopenmpi-dev openmpi-bin fonts-dejavu-core povray"
glint_package_packages="dpkg-dev debhelper dh-python fakeroot lintian xz-utils python3"

# install_missing PACKAGE...
install_missing() {
    local missing="" package
    for package in "$@"; do
        dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing="$missing $package"
    done
    if [ -z "$missing" ]; then
        echo "== packages: all there"
        return
    fi
    if ! command -v apt-get >/dev/null; then
        echo "These packages are missing, and this is no Debian with apt-get to install them:$missing" >&2
        return 1
    fi
    local as_root=""
    if [ "$(id -u)" -ne 0 ]; then as_root="sudo"; fi
    echo "== packages: installing$missing"
    # A fresh machine often updates itself in the background, and holds the lock meanwhile.
    local get="$as_root env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300"
    # An index may be missing or too old to install from; then it is fetched once.
    # shellcheck disable=SC2086
    $get install -y --no-install-recommends $missing >/dev/null 2>&1 ||
        { echo "== packages: updating the package lists first"
          $get update >/dev/null && $get install -y --no-install-recommends $missing >/dev/null; }
}

step() { echo "== $*"; }
