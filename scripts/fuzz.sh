#!/usr/bin/env bash
# Runs every fuzz target for so many seconds, from its corpus, and prints what came of it. What a target learns is kept in
# build/fuzz/corpus/TARGET and used the next time, how often it ran in build/fuzz/runs/TARGET ("in all"); an input that broke something
# is kept in build/fuzz/findings, and the exit code is 1. runs/s are per second of processor time, coverage is of edges.
#   scripts/fuzz.sh SECONDS [TARGET...]      scripts/fuzz.sh 60 aedat4 config
# RUNS=10000000: a target is finished when it has run so often in all, and left out where it already has.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
expect_arguments 1 99 "$@"
cd "$(dirname "$0")/.."
seconds=$1
expect_number fuzz SECONDS "$seconds"
expect_number fuzz RUNS "${RUNS:-1}"
shift

cmake --preset fuzz >/dev/null
cmake --build --preset fuzz ${1:+--target "${@/#/fuzz_}"} >&2
targets=("$@")
if [ $# -eq 0 ]; then
  for program in build/fuzz/tests/fuzz/fuzz_*; do
    if [ -f "$program" ] && [ -x "$program" ]; then targets+=("${program##*/fuzz_}"); fi
  done
fi

# Of what has run: user and system, in ms. So rates do not depend on how busy the machine is.
look_at_processor() {
  times >"$times" # in this shell: a pipe's has none of its own
  processor_ms=$(awk -F '[ms ]+' 'NR == 2 { printf "%d", (($1 + $3) * 60 + $2 + $4) * 1000 }' "$times")
}
times=$(mktemp)
trap 'rm -f "$times"' EXIT
findings=build/fuzz/findings
counts=build/fuzz/runs
mkdir -p "$findings" "$counts"
# Freed memory is kept apart for the last 8 MiB, not 256: what is asked for is then warm, and runs are two to five times as quick.
export ASAN_OPTIONS=quarantine_size_mb=8:malloc_context_size=6:max_malloc_fill_size=256${ASAN_OPTIONS:+:$ASAN_OPTIONS}
failed=0
printf '%-16s %12s %12s %10s %9s %9s %9s\n' target runs 'in all' runs/s coverage inputs findings
for target in "${targets[@]}"; do
  had=$(cat "$counts/$target" 2>/dev/null || echo 0)
  if [ -n "${RUNS:-}" ] && [ "$had" -ge "$RUNS" ]; then continue; fi
  kept=build/fuzz/corpus/$target seeds=tests/fuzz/corpus/$target log=$findings/$target.log
  mkdir -p "$kept"
  # -entropic=0: the bookkeeping of libFuzzer's schedule takes a fifth of the time, and half of it where an input reaches much.
  # Inputs up to twice the largest seed: small ones are quick.
  longest=$({ find "$seeds" -type f -printf '%s\n' 2>/dev/null || true; } | sort -n | tail -1)
  most=$((2 * ${longest:-0} > 512 ? 2 * ${longest:-0} : 512))
  began=$(find "$findings" -name "$target-*" ! -name '*-slow-unit-*' | wc -l)
  look_at_processor
  before=$processor_ms
  "build/fuzz/tests/fuzz/fuzz_$target" -max_total_time="$seconds" ${RUNS:+-runs=$((RUNS - had))} -max_len="$most" -timeout=10 -entropic=0 -print_funcs=0 -print_final_stats=1 \
    -artifact_prefix="$findings/$target-" "$kept" $([ ! -d "$seeds" ] || echo "$seeds") >"$log" 2>&1 </dev/null || failed=1
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  look_at_processor
  rate=$((${runs:-0} * 1000 / (processor_ms - before + 1)))
  found=$(($(find "$findings" -name "$target-*" ! -name '*-slow-unit-*' | wc -l) - began))
  coverage=$({ grep -o 'cov: [0-9]*' "$log" || true; } | tail -1 | cut -d' ' -f2)
  in_all=$((had + ${runs:-0}))
  echo "$in_all" >"$counts/$target"
  printf '%-16s %12s %12s %10s %9s %9s %9s\n' "$target" "${runs:--}" "$in_all" "$rate" "${coverage:--}" "$(find "$kept" -type f | wc -l)" "$found"
done
if [ "$failed" -ne 0 ]; then
  echo "fuzz: failed; inputs and logs are in $findings" >&2
  exit 1
fi
