#!/usr/bin/env bash
# What .ci/run has no time for: clang-tidy over every source file, the tests under the sanitizers, a minute of fuzzing, and the API pages. An hour or
# two on two cores; before a release, and after changes to parsers, threads or memory.
#   scripts/check.sh [api] [tidy] [asan] [tsan] [fuzz]      some of it; without arguments all
set -euo pipefail
cd "$(dirname "$0")/.."
fuzz_seconds=2  # of each target: a minute of all together

tidy() {
  cmake --preset dev >/dev/null
  # Headers that the build writes.
  cmake --build --preset dev
  find src pipeline replay drivers -name '*.cpp' -print0 | xargs -0 -n 1 -P "$(nproc)" clang-tidy -p build/dev --quiet
}

# A warning fails.
api() {
  mkdir -p build
  doxygen docs/Doxyfile
}

scripts/install-packages.sh --tests
for check in "${@:-all}"; do
  case $check in
    all) scripts/check-format.sh; api; tidy; scripts/test.sh asan; scripts/test.sh tsan; scripts/fuzz.sh $fuzz_seconds ;;
    api) api ;;
    tidy) tidy ;;
    fuzz) scripts/fuzz.sh $fuzz_seconds ;;
    asan | tsan) scripts/test.sh "$check" ;;
    *) echo "check: expected api, tidy, asan, tsan or fuzz, found $check" >&2; exit 2 ;;
  esac
done
echo "check: passed"
