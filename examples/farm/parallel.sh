#!/bin/sh
# Renders one image by GNU parallel, on this machine or on those of a login file.
#   examples/farm/parallel.sh SCENE IMAGE PARTS [options of parallel, such as --sshloginfile machines --workdir .]
# A part that fails is tried three times; existing parts are not rendered again.
set -eu
scene=$1 picture=$2 parts=$3
shift 3
folder=$picture.parts
mkdir -p "$folder"
seq "$parts" | parallel --retries 3 --halt now,fail=1 "$@" \
    "test -e '$folder'/{}.part || glint render '$scene' --part {}/$parts -o '$folder'/{}.part -q"
glint merge "$folder"/*.part -o "$picture"
rm -r "$folder"
