# Sourced by tools/test and tools/test-more: names what is done, and says at the end what each stage took.

stage_rows=()
stage_running=""

cpu_seconds() { # of all finished children, into the variable cpu
    local line
    times >"$stage_times"
    line=$(tail -n 1 "$stage_times")
    cpu=$(awk -F'[ms ]' '{ printf "%d", $1 * 60 + $2 + $4 * 60 + $5 }' <<<"$line")
}

# stage NAME COMMAND...: runs the command; the script ends if it fails.
stage() {
    local name=$1 begin=$SECONDS cpu before
    shift
    echo "== $name"
    stage_running=$name
    cpu_seconds
    before=$cpu
    "$@"
    cpu_seconds
    stage_rows+=("$(printf '%-40s %6d s %8d s' "$name" $((SECONDS - begin)) $((cpu - before)))")
    stage_running=""
}

stage_table() {
    local row cpu
    cpu_seconds
    printf '\n%-40s %8s %10s\n' "stage" "elapsed" "processor"
    for row in ${stage_rows[@]+"${stage_rows[@]}"}; do echo "$row"; done
    [ -z "$stage_running" ] || printf '%-40s   FAILED\n' "$stage_running"
    printf '%-40s %6d s %8d s\n' "all" "$SECONDS" "$cpu"
    rm -f "$stage_times"
}
stage_times=$(mktemp)
trap stage_table EXIT
