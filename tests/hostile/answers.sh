#!/bin/bash
# answers.sh GLINT FOLDER [no-limit]: checks that glint refuses each file of FOLDER with the exit code of the command, in one line without
# control characters, within ten seconds of processor time and below 1 GiB (no-limit: for sanitized builds). Prints wrong answers and exits with 1.
set -u
glint=$(realpath "$1")
folder=$(realpath "$2")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$folder"/scenes/* "$folder"/pictures/* "$work"
cd "$work" || exit 1
mkfifo fifo.png
ln -s loop.mtl loop.mtl
# A material library of 2000 materials, read 20,000 times; 200 materials that each read an image twice.
for _ in {1..2000}; do printf 'newmtl a\nKd 1 1 1\n'; done >m2.mtl
for i in {0..199}; do printf 'newmtl m%d\nmap_Kd cover.png\nmap_d ./cover.png\n' "$i"; done >cover.mtl
{ for _ in {1..10000}; do printf 'mtllib m2.mtl\nmtllib ./m2.mtl\n'; done && printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n'; } >libs.obj
# Inputs that took quadratic time: elements of a header, parts of a line, objects of a mesh, points that are not finite, names of
# meshes, tracks of an animation.
{ printf 'ply\nformat ascii 1.0\n' && seq -f 'element e%.0f 0' 100000 && printf 'end_header\n'; } >elements.ply
{
    printf 'solid\n'
    yes $'facet normal 0 0 1\nouter loop\nvertex nan 0 0\nvertex nan 0 0\nvertex nan 0 0\nendloop\nendfacet' | head -n 210000
    printf 'endsolid\n'
} >nans.stl
{
    printf '{"meshes": {"m": {"file": "one.obj"}' && seq -f ', "m%.0f": {"file": "one.obj"}' 20000
    printf '}, "camera": {"eye": [0, 0, 5], "target": [0, 0, 9]}, "objects": [{"type": "mesh", "mesh": "m"}'
    seq -f ', {"type": "mesh", "mesh": "m%.0f"}' 20000 && printf ']}'
} >names.json
{ printf 'v 0 0 0\nf' && seq -f ' 1 %.0f \' 400000; } >parts.obj
# A name of 20 MB, and one with control sequences of terminals.
{ printf '{"' && head -c 20000000 /dev/zero | tr '\0' a && printf '": 1}'; } >name.json
printf '{"\xc2\x9b31m\xe2\x80\xae": 1}' >steer.json
{
    printf '{"meshes": {"m": {"file": "one.obj"}}, "camera": {"eye": [0, 0, 5], "target": [0, 0, 9]}, "objects": ['
    for _ in {1..39999}; do printf '{"type": "mesh", "mesh": "m"},'; done
    printf '{"type": "mesh", "mesh": "m"}]}'
} >objects.json
{
    printf '{"camera": {"eye": [0, 0, 5], "target": [0, 0, 9]}, "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1}'
    seq -f ', {"type": "sphere", "center": [%.0f, 0, 0], "radius": 1}' 40000
    printf '], "animation": {"tracks": [{"target": "/objects/0/radius", "times": [0], "values": [1]}'
    seq -f ', {"target": "/objects/%.0f/radius", "times": [0], "values": [1]}' 40000 && printf ']}}'
} >tracks.json
# Unknown keys at the root, before keys that glint looks up for each of many nodes.
{
    printf '{' && seq -f '"k%.0f": 0,' 100000
    printf '"asset": {"version": "2.0"}, "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "accessors": [{"bufferView": 0,'
    printf '"componentType": 5126, "count": 3, "type": "VEC3"}], "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{'
    printf '"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}], "nodes": ['
    seq -f '{"mesh": 0, "translation": [%.0f, 0, 0]},' 30000 && printf '{"mesh": 0}]}'
} >keys.gltf
# Each missing file causes a warning.
{ printf 'mtllib ' && seq -s ' ' -f 'm%.0f.mtl' 20000 && printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n'; } >gone.obj
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >one.obj
# Legal files, which glint renders: names that warnings repeat, missing names, an image that many materials use.
drawn=" escape.obj loop.obj longlib.obj cover.obj img_http.gltf img_nul.gltf img_pct.gltf jpegbomb1.gltf "
faults=0 count=0

# answer CODE ARGUMENT...
answer() {
    local expected=$1 code lines
    shift
    (
        [ "${no_limit:-}" ] || ulimit -v 1048576
        ulimit -t 10
        "$glint" "$@" </dev/null >out 2>err
        echo $? >code
    )
    code=$(cat code)
    count=$((count + 1))
    if [ "$code" != "$expected" ]; then
        fault "$*" "exit code $code, not $expected"
    fi
    lines=$(wc -l <err)
    if [ "$expected" != 0 ] && [ "$lines" != 1 ]; then fault "$*" "not one line"; fi
    if tr -d '\n' <err | LC_ALL=C grep -qP '[[:cntrl:]]|\xc2[\x80-\x9f]|\xe2\x80[\xa8-\xae]'; then fault "$*" "control characters"; fi
    if [ "$(wc -c <err)" -gt 8192 ]; then fault "$*" "more than 8 KiB"; fi
}

fault() {
    echo "glint $1: $2: $(head -c 300 err | tr -c '[:print:]' '?')"
    faults=$((faults + 1))
}

no_limit=${3:-}
for file in $(cd "$folder/pictures" && ls); do answer 1 diff "$file" "$file"; done
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
for file in elements.ply parts.obj name.json steer.json; do answer 3 render $file --backend cpu --size 8x8 -o picture.png; done
answer 3 trace one.obj --backend cpu --rays /dev/zero
for file in objects.json names.json tracks.json nans.stl keys.gltf; do answer 0 render $file --backend cpu --size 8x8 -o picture.png; done
answer 0 render gone.obj --backend cpu --size 8x8 -o picture.png
answer 0 render libs.obj --backend cpu --size 8x8 -o picture.png
echo "$count answers, $faults of them wrong"
[ "$faults" = 0 ]
