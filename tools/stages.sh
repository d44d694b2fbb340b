# Sourced by tools/test, tools/test-more and .ci/run: runs stages, each with its output in a log, and prints one line for each.

stage_rows=()
stage_running=""
stage_logs=build-logs
stage_begin=$SECONDS

cpu_seconds() { # of all finished children, into the variable cpu
    local line
    times >"$stage_times"
    line=$(tail -n 1 "$stage_times")
    cpu=$(awk -F'[ms ]' '{ printf "%d", $1 * 60 + $2 + $4 * 60 + $5 }' <<<"$line")
}

# On a terminal: the last line of the output, in place.
show_progress() {
    awk '{ printf "\r\033[K%.100s", $0; fflush() } END { printf "\r\033[K" }'
}

# stage NAME COMMAND...: runs the command, its output in build-logs/NAME. The script ends if it fails.
stage() {
    local name=$1 begin=$SECONDS cpu before
    shift
    stage_running=$name
    mkdir -p "$stage_logs"
    cpu_seconds
    before=$cpu
    if [ -t 1 ]; then
        ("$@") 2>&1 | tee "$stage_logs/$name" | show_progress
    else
        ("$@") >"$stage_logs/$name" 2>&1
    fi
    cpu_seconds
    printf '%-14s %5d s elapsed %6d s of processor time   %s\n' "$name" $((SECONDS - begin)) $((cpu - before)) "$(stage_result "$name")"
    stage_running=""
}

# What CTest counted, if it ran.
stage_result() {
    sed -n 's/^100% tests passed, .* out of \([0-9]*\)$/\1 tests passed/p' "$stage_logs/$1" | tail -n 1
}

stage_end() {
    local code=$? cpu
    if [ -n "$stage_running" ]; then
        printf '%-14s FAILED\n' "$stage_running"
        tools/failures "$stage_logs/$stage_running"
    fi
    cpu_seconds
    printf '%-14s %5d s elapsed %6d s of processor time\n' "all" $((SECONDS - stage_begin)) "$cpu"
    rm -f "$stage_times"
    [ -z "$stage_running" ] || echo "whole log: $stage_logs/$stage_running"
    exit "$code"
}
stage_times=$(mktemp)
trap stage_end EXIT
