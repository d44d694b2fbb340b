#!/usr/bin/env bash
# tools/verify-all says how many scenes failed, and fails with them: verify_all_test.sh GLINT SOURCE
set -uo pipefail
glint=$1 source=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
wrong=0

# expect NAME WANTED_CODE WANTED_LINE PROGRAM SCENE...
expect() {
    local name=$1 code=$2 line=$3 program=$4
    shift 4
    local said
    said=$(CONFIGURATIONS=default SIZE=80x60 SCENES="$*" "$source/tools/verify-all" "$program" 2>&1)
    local got=$?
    if [ "$got" -ne "$code" ] || ! grep -qxF "$line" <<<"$said"; then
        printf '%s: exit code %s instead of %s, or no line "%s" in:\n%s\n' "$name" "$got" "$code" "$line" "$said"
        wrong=1
    fi
}

# A program that says of each scene what its name tells.
cat >"$folder/program" <<'END'
#!/usr/bin/env bash
case $2 in
    *good*) exit 0 ;;
    *many*) echo "$2: FAILED: too many pixels differ"; echo "100 pixels; differing: 0 edge, 9 tie (9 % explained, at most 0.5 %), 0 unexplained"; exit 5 ;;
    *unexplained*) echo "100 pixels; differing: 0 edge, 0 tie (0 % explained, at most 0.5 %), 3 unexplained"; exit 5 ;;
    *) echo "glint: $2: no such file"; exit 3 ;;
esac
END
chmod +x "$folder/program"
expect "a good scene" 0 "default: 1 of 1 verified, 0 failed" "$folder/program" good
expect "too many differ" 1 "default: 1 of 2 verified, 1 failed" "$folder/program" good many
expect "all ways to fail" 1 "verify-all: 3 verifications failed" "$folder/program" many good unexplained missing

# The program itself, on a scene of ties: in its place it may have them, anywhere else it fails.
ties=$source/scenes/stiff/coplanar_decals.json
cp "$ties" "$folder/ties.json"
expect "ties in their place" 0 "default: 1 of 1 verified, 0 failed" "$glint" "$ties"
expect "ties elsewhere" 1 "default: 1 of 2 verified, 1 failed" "$glint" "$folder/ties.json" "$source/scenes/spheres.json"
exit $wrong
