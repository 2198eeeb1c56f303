#!/usr/bin/env bash
# What .ci/run has no time for: clang-tidy over all C++ but the tests, the tests under the sanitizers, a minute of fuzzing, the API pages, and a wheel for
# Python, the library of events to frames alone, the program without what can be left out, Debian packages in a system of their own, and frames on ARM, in
# emulation. An hour or two on two cores; before a release, and after changes to parsers, threads or memory.
#   scripts/check.sh [api] [wheel] [core] [bare] [packages] [arm] [tidy] [asan] [tsan] [fuzz]      some of it; without arguments all
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
wanted=("${@:-all}")
for check in "${wanted[@]}"; do
  case $check in
    all | api | wheel | core | bare | packages | arm | tidy | asan | tsan | fuzz) ;;
    *) refuse "check: expected api, wheel, core, bare, packages, arm, tidy, asan, tsan or fuzz, found '$check'" ;;
  esac
done
cd "$(dirname "$0")/.."
fuzz_seconds=2  # of each target: a minute of all together

# Beside the compiler, so that the second time it takes what changed alone; all that it finds is shown before it fails.
tidy() {
  cmake --preset tidy >/dev/null
  cmake --build --preset tidy -- -k 0
}

# A warning fails.
api() {
  mkdir -p build
  doxygen docs/Doxyfile
}

# Those that make a folder are shells of their own, so that what they leave goes also where they fail or are interrupted.

# As a user installs it, and his first frames.
wheel() (
  place=$(mktemp -d)
  trap 'rm -rf "$place"' EXIT
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
)

# Every option off: a library that needs Highway and TBB, for which there is no io.
core() (
  place=$(mktemp -d)
  trap 'rm -rf "$place"' EXIT
  cmake -S . -B build/core -G Ninja -DCMAKE_BUILD_TYPE=Release -DEVENTIDE_TESTS=OFF -DEVENTIDE_IO=OFF -DEVENTIDE_ONEDNN=OFF -DBUILD_SHARED_LIBS=ON
  cmake --build build/core
  cmake --install build/core --prefix "$place/eventide"
  needed=$(readelf -d "$place"/eventide/lib*/libeventide-core.so | sed -n 's/.*Shared library: .\(lib[a-z]*\)\..*/\1/p' | sort | tr '\n' ' ')
  [[ $needed == "libc libgcc libhwy libm libstdc libtbb " || $needed == "libc libhwy libm libtbb " ]] ||
    { echo "core: expected libhwy and libtbb of packages, found $needed" >&2; exit 1; }
  [[ ! -e $place/eventide/bin ]]
  cmake -S examples -B "$place/examples" -DCMAKE_PREFIX_PATH="$place/eventide"
  cmake --build "$place/examples"
  printf '64 48\n0.001 1 1 1\n0.2 2 2 0\n' >"$place/events.txt"
  "$place/examples/from_text" "$place/events.txt" "$place/frames"
  [[ -s $place/frames ]]
  printf 'cmake_minimum_required(VERSION 3.25)\nproject(asks LANGUAGES CXX)\nfind_package(eventide 1 REQUIRED COMPONENTS io)\n' >"$place/CMakeLists.txt"
  if cmake -S "$place" -B "$place/asks" -DCMAKE_PREFIX_PATH="$place/eventide" 2>"$place/words"; then
    echo "core: expected component io to be refused, found it accepted" >&2
    exit 1
  fi
  grep -q "component 'io'" "$place/words"
)

# The program without what an option can leave out: frames as ever, and a refusal in words, no file left, where one needs what is missing.
bare() (
  place=$(mktemp -d)
  trap 'rm -rf "$place"' EXIT
  cmake -S . -B build/bare -G Ninja -DCMAKE_BUILD_TYPE=Release -DEVENTIDE_TESTS=OFF -DEVENTIDE_TRAIN=OFF -DEVENTIDE_PYTHON=OFF -DEVENTIDE_VIDEO=OFF \
    -DEVENTIDE_COMPRESSION=OFF -DEVENTIDE_HDF5=OFF -DEVENTIDE_SQLITE=OFF -DEVENTIDE_HTTP=OFF -DEVENTIDE_ROS2=OFF -DEVENTIDE_USB=OFF -DEVENTIDE_ONEDNN=OFF
  cmake --build build/bare
  program=build/bare/apps/cli/eventide
  "$program" simulate --scene demo --seconds 0.3 --size 64x48 --out "$place/recording.aedat4"
  "$program" run "$place/recording.aedat4" --out "y4m:$place/video.y4m"
  [[ $(head -c 9 "$place/video.y4m") == YUV4MPEG2 ]]
  if "$program" run "$place/recording.aedat4" --out "$place/video.mp4" 2>"$place/words"; then
    echo "bare: expected mp4 to be refused, found it accepted" >&2
    exit 1
  fi
  grep -q EVENTIDE_VIDEO "$place/words"
  [[ ! -e $place/video.mp4 ]]
)

# A clean Debian 12, made by debootstrap: packages are installed and run, and programs in C and Python built on them give the frames of
# `eventide run`. As root, with Debian's archive at hand.
packages() (
  place=$(mktemp -d)
  system=$place/system
  trap 'umount "$system/proc" 2>/dev/null || true; rm -rf --one-file-system "$place"' EXIT
  cmake --preset release >/dev/null
  cmake --build --preset release
  cpack --config build/release/CPackConfig.cmake -B "$place/packages"
  debootstrap --variant=minbase bookworm "$system"
  mount -t proc proc "$system/proc"
  cp "$place"/packages/*.deb examples/reconstruct.c examples/reconstruct.py "$system/root/"
  cp /etc/resolv.conf "$system/etc/"
  chroot "$system" sh -euc '
    cd /root
    apt-get update -q
    DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends gcc libc6-dev pkg-config ./*.deb
    eventide simulate --scene demo --seconds 1 --size 96x72 --out recording.aedat4
    eventide run recording.aedat4 --out video.mp4 --uncertainty side
    eventide run recording.aedat4 --precision f32 --out grayf32:theirs --uncertainty separate --sigma-white 1
    cc -std=c11 reconstruct.c -o reconstruct $(pkg-config --cflags --libs eventide)
    ./reconstruct recording.aedat4 in_c
    python3 reconstruct.py recording.aedat4 in_python
    cmp in_c theirs
    cmp in_python theirs'
)

scripts/install-packages.sh --tests
for check in "${wanted[@]}"; do
  case $check in
    all) scripts/check-format.sh; api; wheel; core; bare; packages; scripts/check-arm.sh; tidy; scripts/test.sh asan; scripts/test.sh tsan; scripts/fuzz.sh $fuzz_seconds ;;
    api) api ;;
    wheel) wheel ;;
    core) core ;;
    bare) bare ;;
    packages) packages ;;
    arm) scripts/check-arm.sh ;;
    tidy) tidy ;;
    fuzz) scripts/fuzz.sh $fuzz_seconds ;;
    asan | tsan) scripts/test.sh "$check" ;;
  esac
done
echo "check: passed"
