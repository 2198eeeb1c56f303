#!/usr/bin/env bash
# What .ci/run has no time for: clang-tidy over every source file, the tests under the sanitizers, and a minute of fuzzing. An hour or two on two
# cores; before a release, and after changes to parsers, threads or memory.
#   scripts/check.sh [tidy] [asan] [tsan] [fuzz]      some of it; without arguments all
set -euo pipefail
cd "$(dirname "$0")/.."
fuzz_seconds=60  # of all targets together

tidy() {
  cmake --preset dev >/dev/null
  # Headers that the build writes.
  cmake --build --preset dev
  find src pipeline replay drivers -name '*.cpp' -print0 | xargs -0 -n 1 -P "$(nproc)" clang-tidy -p build/dev --quiet
}

fuzz() {
  cmake --preset fuzz >/dev/null
  cmake --build --preset fuzz
  local targets=(build/fuzz/tests/fuzz/fuzz_*) found
  found=$(mktemp -d)
  for target in "${targets[@]}"; do
    [ -x "$target" ] && [ -f "$target" ] || continue
    local name=${target##*/fuzz_} seeds=()
    [ -d "tests/fuzz/corpus/$name" ] && seeds=("tests/fuzz/corpus/$name")
    mkdir "$found/$name"
    echo "fuzzing $name ..."
    if ! "$target" -max_total_time=$((fuzz_seconds / ${#targets[@]} + 1)) -print_final_stats=1 -artifact_prefix="$found/$name-" \
      "$found/$name" "${seeds[@]}" >"$found/$name.log" 2>&1; then
      tail -n 40 "$found/$name.log" >&2
      echo "fuzz: $name failed; what it was given is in $found" >&2
      return 1
    fi
    grep "number_of_executed_units" "$found/$name.log"
  done
  rm -r "$found"
}

scripts/install-packages.sh --tests
for check in "${@:-all}"; do
  case $check in
    all) scripts/check-format.sh; tidy; scripts/test.sh asan; scripts/test.sh tsan; fuzz ;;
    tidy | fuzz) "$check" ;;
    asan | tsan) scripts/test.sh "$check" ;;
    *) echo "check: expected tidy, asan, tsan or fuzz, found $check" >&2; exit 2 ;;
  esac
done
echo "check: passed"
