#!/usr/bin/env bash
# What .ci/run has no time for: clang-tidy over the libraries' source files, the tests under the sanitizers, a minute of fuzzing, the API pages, and a wheel for
# Python, and the library of events to frames alone. An hour or two on two cores; before a release, and after changes to parsers, threads or memory.
#   scripts/check.sh [api] [wheel] [core] [tidy] [asan] [tsan] [fuzz]      some of it; without arguments all
set -euo pipefail
cd "$(dirname "$0")/.."
fuzz_seconds=2  # of each target: a minute of all together

tidy() {
  cmake --preset dev >/dev/null
  # Headers that the build writes.
  cmake --build --preset dev
  find src pipeline replay drivers library python -name '*.cpp' -print0 | xargs -0 -n 1 -P "$(nproc)" clang-tidy -p build/dev --quiet
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

# Every option off: a library that needs Highway and TBB, for which there is no io.
core() {
  local place needed
  place=$(mktemp -d)
  trap 'rm -rf "$place"' RETURN
  cmake -S . -B build/core -G Ninja -DCMAKE_BUILD_TYPE=Release -DEVENTIDE_TESTS=OFF -DEVENTIDE_IO=OFF -DEVENTIDE_ONEDNN=OFF -DBUILD_SHARED_LIBS=ON
  cmake --build build/core
  cmake --install build/core --prefix "$place/eventide"
  needed=$(readelf -d "$place"/eventide/lib*/libeventide-core.so | sed -n 's/.*Shared library: .\(lib[a-z]*\)\..*/\1/p' | sort | tr '\n' ' ')
  [[ $needed == "libc libgcc libhwy libm libstdc libtbb " || $needed == "libc libhwy libm libtbb " ]] ||
    { echo "core: expected libhwy and libtbb of packages, found $needed" >&2; return 1; }
  [[ ! -e $place/eventide/bin ]]
  cmake -S examples -B "$place/examples" -DCMAKE_PREFIX_PATH="$place/eventide"
  cmake --build "$place/examples"
  printf '64 48\n0.001 1 1 1\n0.2 2 2 0\n' >"$place/events.txt"
  "$place/examples/from_text" "$place/events.txt" "$place/frames"
  [[ -s $place/frames ]]
  printf 'cmake_minimum_required(VERSION 3.25)\nproject(asks LANGUAGES CXX)\nfind_package(eventide 1 REQUIRED COMPONENTS io)\n' >"$place/CMakeLists.txt"
  if cmake -S "$place" -B "$place/asks" -DCMAKE_PREFIX_PATH="$place/eventide" 2>"$place/words"; then
    echo "core: expected component io to be refused, found it accepted" >&2
    return 1
  fi
  grep -q "component 'io'" "$place/words"
}

scripts/install-packages.sh --tests
for check in "${@:-all}"; do
  case $check in
    all) scripts/check-format.sh; api; wheel; core; tidy; scripts/test.sh asan; scripts/test.sh tsan; scripts/fuzz.sh $fuzz_seconds ;;
    api) api ;;
    wheel) wheel ;;
    core) core ;;
    tidy) tidy ;;
    fuzz) scripts/fuzz.sh $fuzz_seconds ;;
    asan | tsan) scripts/test.sh "$check" ;;
    *) echo "check: expected api, wheel, core, tidy, asan, tsan or fuzz, found $check" >&2; exit 2 ;;
  esac
done
echo "check: passed"
