#!/bin/sh
# tools/verify_all.sh GLINT [SIZE [SCENE...]]
#
# Verifies every scene of scenes/ with every build quality and both traversals; exit code 1 if any pixel is
# unexplained. Where packets do not know a scene the second traversal is that by lanes again. Half an hour on
# two cores at 320x240.
set -u
glint=$1
size=${2:-320x240}
[ $# -ge 2 ] && shift 2 || shift 1
[ $# -eq 0 ] && set -- "$(dirname "$0")"/../scenes/*.json
failed=0
for scene in "$@"; do
    case $scene in *.schema.json) continue ;; esac
    for quality in fast default high; do
        for traversal in lane packet; do
            if ! output=$("$glint" verify "$scene" --size "$size" --build-quality $quality --traversal $traversal 2>&1); then
                failed=1
                printf '%s\n' "$output"
                echo "FAILED: $scene --build-quality $quality --traversal $traversal"
            fi
        done
    done
    echo "done: $(basename "$scene")"
done
exit $failed
