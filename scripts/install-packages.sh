#!/usr/bin/env bash
# Installs what a fresh Debian 12 lacks to build, run and test eventide. As root or through sudo; asks nothing.
#   scripts/install-packages.sh            to build and run
#   scripts/install-packages.sh --tests    also what the tests, benchmarks and training need
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
expect_arguments 0 1 "$@"
case "${1:-}" in "" | --tests) ;; *) refuse "packages: expected --tests or nothing, found '$1'" ;; esac

build=(
  g++ cmake ninja-build ccache pkg-config
  libopencv-dev libeigen3-dev nlohmann-json3-dev libtbb-dev libhwy-dev libdnnl-dev
  libconcurrentqueue-dev liblz4-dev libzstd-dev zlib1g-dev libbz2-dev
  libcli11-dev libtomlplusplus-dev libspdlog-dev
  libavcodec-dev libavformat-dev libavutil-dev
  libusb-1.0-0-dev libhdf5-dev libsqlite3-dev libcpp-httplib-dev
  cyclonedds-dev cyclonedds-tools libyaml-dev
  python3-dev python3-numpy pybind11-dev
)
tests=(
  libgtest-dev libgmock-dev libbenchmark-dev libflatbuffers-dev flatbuffers-compiler-dev flatbuffers-compiler libumockdev-dev umockdev
  libtorch-dev libopenblas0-pthread libjemalloc2 ffmpeg python3
  libfastrtps-dev libfastcdr-dev
  clang clang-format clang-tidy libclang-rt-14-dev git
  dpkg-dev file chromium doxygen zsh fish debootstrap
)
wanted=("${build[@]}")
[ "${1:-}" = "--tests" ] && wanted+=("${tests[@]}")

missing=()
for package in "${wanted[@]}"; do
  state=$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null || true)
  [ "$state" = "install ok installed" ] || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  echo "packages: all ${#wanted[@]} are installed"
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "packages: missing ${missing[*]}; run this as root, or install sudo" >&2; exit 1; }
  as_root=(sudo)
fi
echo "packages: installing ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -q
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}"
