#!/bin/bash
# Renders one image by GNU parallel, on this machine or on those of a login file.
#   examples/farm/parallel.sh SCENE IMAGE PARTS [options of parallel, such as --sshloginfile machines --workdir .]
# A part that fails is tried three times; existing parts are not rendered again.
set -eu
scene=$(printf %q "$1") picture=$2 parts=$3
folder=$(printf %q "$picture.parts")
shift 3
mkdir -p "$picture.parts"
seq "$parts" | parallel --retries 3 --halt now,fail=1 "$@" \
    "test -e $folder/{}.part || glint render $scene --part {}/$parts -o $folder/{}.part -q"
seq -f "$picture.parts/%g.part" "$parts" | tr '\n' '\0' | xargs -0 sh -c 'glint merge "$@" -o "$0"' "$picture"
rm -r "$picture.parts"
