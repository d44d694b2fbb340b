#!/usr/bin/env bash
# A film of frames by the guide's own command (docs/guide/farm.md), with ffmpeg: film_test.sh GLINT SOURCE
set -euo pipefail
glint=$(realpath "$1")
source=$(realpath "$2")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

"$glint" render "$source/scenes/turntable.json" --frames 0:11 --size 64x40 -q -o frame.##.png
command=$(grep -m 1 '^ffmpeg .*frame.%02d.png' "$source/docs/guide/farm.md")
# shellcheck disable=SC2086
$command -loglevel error </dev/null
found=$(ffprobe -v error -count_frames -show_entries stream=width,height,nb_read_frames,r_frame_rate -of csv=p=0 film.mp4)
[ "$found" = "64,40,24/1,12" ] || { echo "film_test: a film of $found" >&2; exit 1; }
# Each of two frames shows what was drawn for it, not for the other; compression changes it a little.
ffmpeg -loglevel error -i film.mp4 out.%02d.png </dev/null
rmse() { { "$glint" diff "frame.$1.png" "out.$2.png" || true; } | sed -n 's/^RMSE \([^,]*\),.*/\1/p'; }
for trial in "00 01 12" "11 12 01"; do
    read -r drawn shown other <<<"$trial"
    awk -v same="$(rmse "$drawn" "$shown")" -v other="$(rmse "$drawn" "$other")" 'BEGIN { exit !(0 < same && 2 * same < other) }' ||
        { echo "film_test: frame $drawn is not the film's: RMSE $(rmse "$drawn" "$shown"), of another $(rmse "$drawn" "$other")" >&2; exit 1; }
done
echo "film_test: ok"
