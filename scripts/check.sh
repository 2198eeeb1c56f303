#!/usr/bin/env bash
# What .ci/run has no time for: clang-tidy over every source file, the tests under the sanitizers, a minute of fuzzing, the API pages, and a wheel for
# Python. An hour or two on two cores; before a release, and after changes to parsers, threads or memory.
#   scripts/check.sh [api] [wheel] [tidy] [asan] [tsan] [fuzz]      some of it; without arguments all
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

# As a user installs it, and his first frames.
wheel() {
  local place
  place=$(mktemp -d)
  trap 'rm -rf "$place"' RETURN
  /usr/bin/python3 -m venv --system-site-packages "$place/python"
  "$place/python/bin/pip" install --quiet --no-index --config-settings build-dir="$PWD/build/wheel" .
  "$place/python/bin/python" - <<'END'
import eventide
import numpy

frames = eventide.Reconstructor("default", 64, 48)
events = numpy.zeros(2000, [("t", "<i8"), ("x", "<u2"), ("y", "<u2"), ("p", "i1")])
events["t"] = numpy.arange(2000) * 100
frames.push(events)
print("wheel:", eventide.__version__, frames)
END
}

scripts/install-packages.sh --tests
for check in "${@:-all}"; do
  case $check in
    all) scripts/check-format.sh; api; wheel; tidy; scripts/test.sh asan; scripts/test.sh tsan; scripts/fuzz.sh $fuzz_seconds ;;
    api) api ;;
    wheel) wheel ;;
    tidy) tidy ;;
    fuzz) scripts/fuzz.sh $fuzz_seconds ;;
    asan | tsan) scripts/test.sh "$check" ;;
    *) echo "check: expected api, wheel, tidy, asan, tsan or fuzz, found $check" >&2; exit 2 ;;
  esac
done
echo "check: passed"
