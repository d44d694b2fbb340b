#!/bin/bash
# answers.sh GLINT FOLDER [no-limit]: how the program answers the files of FOLDER. Each is refused with the exit code of its command, in one
# line without control characters, within a second of processor time and below 1 GiB (no-limit: for sanitized builds, whose memory is no
# measure). Prints what is otherwise, and exits with 1.
set -u
glint=$(realpath "$1")
folder=$(realpath "$2")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$folder"/scenes/* "$folder"/pictures/* "$folder"/legal/* "$work"
cd "$work" || exit 1
mkfifo fifo.png
ln -s loop.mtl loop.mtl
{ for _ in {1..10000}; do printf 'mtllib m2.mtl\nmtllib ./m2.mtl\n'; done && printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n'; } >libs.obj
# Legal, but for names that warnings repeat, or that are nowhere, or what many materials ask for again: drawn.
drawn=" escape.obj obj-crash-a4f60e32ab.obj cover.obj "
faults=0 count=0

# answer CODE ARGUMENT...
answer() {
    local expected=$1 code seconds lines
    shift
    (
        [ "${no_limit:-}" ] || ulimit -v 1048576
        ulimit -t 10
        TIMEFORMAT=%U
        { time timeout 60 "$glint" "$@" </dev/null >out 2>err; } 2>seconds
        echo $? >code
    )
    code=$(cat code)
    seconds=$(tail -n 1 seconds)
    count=$((count + 1))
    if [ "$code" != "$expected" ]; then
        fault "$*" "exit code $code, not $expected"
    fi
    lines=$(wc -l <err)
    if [ "$expected" != 0 ] && [ "$lines" != 1 ]; then fault "$*" "not one line"; fi
    if tr -d '\n' <err | LC_ALL=C grep -q '[[:cntrl:]]'; then fault "$*" "control characters"; fi
    if [ -z "${no_limit:-}" ] && [ "${seconds%%.*}" -ge 1 ]; then fault "$*" "$seconds s"; fi
}

fault() {
    echo "glint $1: $2: $(head -c 300 err | tr -c '[:print:]' '?')"
    faults=$((faults + 1))
}

no_limit=${3:-}
for file in $(cd "$folder/pictures" && ls); do answer 1 diff "$file" "$file"; done
# Other readers refused or misread these.
for file in $(cd "$folder/legal" && ls); do answer 0 diff "$file" "$file"; done
answer 1 diff /dev/zero /dev/zero
answer 1 diff fifo.png fifo.png
for file in $(cd "$folder/scenes" && ls | grep -E '\.(json|gltf|obj|ply|stl|nff)$'); do
    if [[ "$drawn" == *" $file "* ]]; then
        answer 0 render "$file" --backend cpu --size 8x8 -o picture.png
    else
        answer 3 render "$file" --backend cpu --size 8x8 -o picture.png
        answer 3 info "$file"
    fi
done
answer 0 render libs.obj --backend cpu --size 8x8 -o picture.png
echo "$count answers, $faults of them wrong"
[ "$faults" = 0 ]
