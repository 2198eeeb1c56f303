#!/usr/bin/env bash
# From a fresh Debian 12 to the result of every test: installs what is missing, builds, runs ctest.
#   scripts/test.sh [PRESET] [CTEST ARGUMENTS]      presets: dev (default), asan, tsan; parsers: of asan, what reads files, streams and settings
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$(dirname "$0")/.."
preset=dev
case "${1:-}" in
  dev | asan | tsan | parsers) preset=$1; shift ;;
  "" | -*) ;;
  *) refuse "test: expected dev, asan, tsan, parsers or arguments of ctest, found '$1'" ;;
esac

scripts/install-packages.sh --tests
echo "building (preset $preset) ..."
cmake --preset "${preset/parsers/asan}" >/dev/null
cmake --build --preset "$preset"
echo "testing ..."
ctest --preset "$preset" --output-on-failure -j "$(nproc)" "$@"
