#!/usr/bin/env bash
# tools/verify-all says how many scenes failed, and fails with them: verify_all_test.sh GLINT SOURCE
set -uo pipefail
glint=$1 source=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
wrong=0

# expect NAME WANTED_CODE WANTED_LINE PROGRAM SCENE... with $configuration
configuration=default
expect() {
    local name=$1 code=$2 line=$3 program=$4
    shift 4
    local said
    said=$(CONFIGURATIONS=$configuration SIZE=80x60 SCENES="$*" "$source/tools/verify-all" "$program" 2>&1)
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
    *many*) echo "$2: FAILED: too many pixels differ"; echo "100 pixels; beyond their predicted error: 9 edge, 0 rounding, 0 undecided (at most 5), 0 unexplained"; exit 5 ;;
    *unexplained*) echo "100 pixels; beyond their predicted error: 0 edge, 0 rounding, 0 undecided (at most 5), 3 unexplained"; exit 5 ;;
    *) echo "glint: $2: no such file"; exit 3 ;;
esac
END
chmod +x "$folder/program"
expect "a good scene" 0 "default: 1 of 1 verified, 0 failed" "$folder/program" good
expect "too many differ" 1 "default: 1 of 2 verified, 1 failed" "$folder/program" good many
expect "all ways to fail" 1 "verify-all: 3 verifications failed" "$folder/program" many good unexplained missing
configuration=algebraic
expect "a textbook loses digits" 0 "algebraic: many: loses digits: 9 edge, 0 rounding, 0 undecided (at most 5)" "$folder/program" good many
expect "a textbook is broken" 1 "algebraic: 1 of 2 verified, 1 failed" "$folder/program" good unexplained

# The program itself, on a scene with coincident surfaces, wherever it lies.
configuration=default
cp "$source/scenes/stiff/coplanar_decals.json" "$folder/decals.json"
expect "decals" 0 "default: 2 of 2 verified, 0 failed" "$glint" "$folder/decals.json" "$source/scenes/spheres.json"
exit $wrong
