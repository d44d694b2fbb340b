#!/usr/bin/env bash
# Installs the Debian packages in a new root, uses them there, and removes them.
#
#   clean_root.sh FOLDER     the folder to which tools/package wrote them
#
# debootstrap makes the root below TMPDIR (2 GB), from the source of this machine's apt. Needs to be root. KEEP=1 keeps it.
set -euo pipefail
top=$(cd "$(dirname "$0")/../.." && pwd)
if [ $# -ne 1 ] || ! ls "$1"/glint_*.deb >/dev/null 2>&1; then
    sed -n '2,6s/^# \{0,1\}//p' "$0" >&2
    exit 2
fi
[ "$(id -u)" -eq 0 ] || { echo "clean_root: needs to be root, for chroot" >&2; exit 2; }
debs=$(cd "$1" && pwd)
release=$(. /etc/os-release && echo "$VERSION_CODENAME")
folder=$(mktemp -d)
root=$folder/root
cleanup() { [ -n "${KEEP:-}" ] && echo "kept: $root" || rm -rf --one-file-system "$folder"; }
trap cleanup EXIT

say() { echo "-- $*"; }
fail() { echo "clean_root: $*" >&2; exit 1; }
# Runs a command in the root, with its own /proc, and with home and Mesa's cache in /tmp, where they count as no leftovers.
inside() {
    unshare --mount sh -c 'mount -t proc proc "$0/proc" && exec chroot "$0" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/tmp/home \
        XDG_CACHE_HOME=/tmp/home LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"' "$root" "$@"
}
quietly() { inside "$@" >"$folder/said" 2>&1 || { tail -n 30 "$folder/said" >&2; fail "$* failed"; }; }

make_root() {
    # "deb SITE RELEASE COMPONENT" of each source from which apt gets Debian's packages here.
    apt-get indextargets --format 'deb $(SITE) $(RELEASE) $(COMPONENT) $(ORIGIN) $(IDENTIFIER)' |
        sed -n 's/ Debian Packages$//p' | sort -u >"$folder/sources"
    local site
    site=$(awk -v release="$release" '$3 == release { print $2; exit }' "$folder/sources")
    [ -n "$site" ] || fail "apt has no source of Debian's $release"
    debootstrap --variant=minbase "$release" "$root" "$site" >"$folder/said" 2>&1 || { tail -n 20 "$folder/said" >&2; fail "debootstrap failed"; }
    cp "$folder/sources" "$root/etc/apt/sources.list"
    apt-config dump | grep -i '^Acquire::.*proxy' >"$root/etc/apt/apt.conf.d/99proxy" || true
    cp -L /etc/resolv.conf "$root/etc/resolv.conf"
    quietly apt-get update
}

# Installs the dependencies of the packages, without the packages, and programs that check their parts.
install_needed() {
    local needed
    needed=$(for deb in "$debs"/*.deb; do dpkg-deb -f "$deb" Depends Recommends; done | sed 's/^[A-Za-z]*: //' | tr '\n' ',' |
        tr ',' '\n' | grep -vE '^ *((python3-|lib)?glint|libglint)[0a-z-]*( |$)' | grep -v '^ *$' | sort -u | tr '\n' ',')
    quietly apt-get satisfy -y --no-install-recommends "${needed%,}, shared-mime-info, man-db, fish, zsh"
}

# Lists all files except those that change by themselves.
listing() {
    (cd "$root" && find . \( -path ./tmp -o -path ./var/log -o -path ./var/cache -o -path ./var/lib/apt -o -path ./proc -o -path ./sys \) -prune -o -print) |
        grep -vE '^\./var/lib/dpkg/[a-z]+-old$' | sort
}

use_program() {
    local multiarch version
    inside glint --version --verbose >"$folder/version"
    version=$(sed -n 's/^project(glint VERSION \([0-9.]*\) .*/\1/p' "$top/CMakeLists.txt")
    grep -qx "glint $version" "$folder/version" || fail "glint --version says $(head -n 1 "$folder/version")"
    grep -qE '^commit: [0-9a-f]{12}$' "$folder/version" || fail "no commit: $(cat "$folder/version")"
    grep -q '^window: GLFW' "$folder/version" || fail "no window: $(cat "$folder/version")"
    grep -q '^device: .*Vulkan 1\.' "$folder/version" || fail "no device: $(cat "$folder/version")"

    # A ray, and images of the installed examples with the hashes of this tree.
    inside glint trace /usr/share/doc/glint/examples/scenes/spheres.json --pixel 320,240 >"$folder/ray" || fail "glint trace failed"
    awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == "t") t = i } NR == 2 { found = $t > 0 && $t < 1e9 } END { exit !found }' \
        "$folder/ray" || fail "a ray hits nothing: $(cat "$folder/ray")"
    mkdir -p "$root/tmp/tree/tests"
    cp -r "$top/tools" "$root/tmp/tree/tools"
    cp "$top/tests/gallery_hashes.txt" "$root/tmp/tree/tests"
    ln -s /usr/share/doc/glint/examples/scenes "$root/tmp/tree/scenes"
    inside env NAMES="spheres knot" bash /tmp/tree/tools/gallery-hashes /usr/bin/glint || fail "an image has another hash"

    # A program in C, compiled outside the root, which has no compiler.
    multiarch=$(basename "$(dirname "$(ls "$root"/usr/lib/*/libglint.so)")")
    gcc -I"$root/usr/include" "$top/examples/c/nearest_hit.c" -o "$root/tmp/nearest_hit" -L"$root/usr/lib/$multiarch" -lglint \
        -Wl,--allow-shlib-undefined
    inside /tmp/nearest_hit | grep -q 'ray 0: geometry 1 at 7.000' || fail "nearest_hit is wrong"
}

# One image by two ranks.
use_mpi() {
    local scene=/usr/share/doc/glint/examples/scenes/spheres.json
    local draw=(glint render "$scene" --size 320x240 --stats json -q -o)
    grep -q '^MPI: MPI ' "$folder/version" || fail "no MPI: $(cat "$folder/version")"
    inside "${draw[@]}" /tmp/one.pfm >"$folder/one" || fail "glint render failed"
    inside env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 timeout 120 mpirun --oversubscribe -n 2 "${draw[@]}" /tmp/two.pfm \
        >"$folder/two" || fail "mpirun glint render failed"
    grep -q '"ranks": 2' "$folder/two" || fail "not two ranks: $(cat "$folder/two")"
    cmp "$root/tmp/one.pfm" "$root/tmp/two.pfm" || fail "two ranks render another image"
}

use_python() {
    local name
    inside python3 -c "import glint" || fail "import glint failed"
    sed -n '/^```python$/,/^```$/p' "$top/README.md" | sed '/^```/d' >"$root/tmp/readme.py"
    inside python3 /tmp/readme.py | grep -qx '\[3\.\]' || fail "the example of README.md does not print [3.]"
    for name in lidar_scan sun_hours sky_view; do
        inside python3 -B "/usr/share/doc/python3-glint/examples/$name.py" "/tmp/$name.png" --size 90 || fail "$name.py failed"
        [ -s "$root/tmp/$name.png" ] || fail "$name.py wrote nothing"
    done
}

use_pages() {
    local command
    for command in $(inside glint --help | sed -n '/^Commands:/,/^$/s/^  \([a-z]*\) .*/\1/p'); do
        inside man --warnings "glint-$command" >"$folder/page" 2>&1 || fail "no man page of glint $command"
        grep -q "glint $command" "$folder/page" || fail "the man page of glint $command is empty"
        ! grep -q 'warning:' "$folder/page" || fail "the man page of glint $command: $(grep warning: "$folder/page")"
    done
    [ -n "${command:-}" ] || fail "glint --help lists no commands"
    inside fish -c 'complete -C "glint render --back"' | grep -q '^--backend' || fail "fish completes nothing"
    inside bash -c 'source /usr/share/bash-completion/completions/glint; COMP_WORDS=(glint ver); COMP_CWORD=1; _glint; echo "${COMPREPLY[*]}"' |
        grep -qx verify || fail "bash completes nothing"
    inside zsh -fc '_describe() { print -l $found; }; words=(glint render --back); CURRENT=3
        complete() { source /usr/share/zsh/vendor-completions/_glint; }; complete' | grep -q '^--backend:' || fail "zsh completes nothing"
    grep -q 'application/x-glint-scene+json:\*\.glint\.json' "$root/usr/share/mime/globs2" || fail "the MIME type of scenes is missing"
}

say "a clean root of $release"
make_root
say "dependencies"
install_needed
listing >"$folder/before"
say "installing"
mkdir "$root/tmp/debs" "$root/tmp/home"
cp "$debs"/*.deb "$root/tmp/debs"
quietly bash -c 'dpkg -i /tmp/debs/*.deb'
say "glint"
use_program
say "glint-mpi"
use_mpi
say "python3-glint"
use_python
say "pages, completions, types"
use_pages
say "removing"
# shellcheck disable=SC2046
quietly dpkg --purge $(for deb in "$debs"/*.deb; do dpkg-deb -f "$deb" Package; done)
listing >"$folder/after"
diff "$folder/before" "$folder/after" >"$folder/leftovers" || { cat "$folder/leftovers" >&2; fail "files before (<) and after (>) differ"; }
say "done"
