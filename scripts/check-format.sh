#!/usr/bin/env bash
# Fails where a source file is not laid out as .clang-format says, and names the places.
#   scripts/check-format.sh [--fix]
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
expect_arguments 0 1 "$@"
case "${1:-}" in "" | --fix) ;; *) refuse "format: expected --fix or nothing, found '$1'" ;; esac
cd "$(dirname "$0")/.."
# Debian 12's: other versions lay out a few things differently.
formatter=clang-format-14
command -v $formatter >/dev/null || { echo "format: expected $formatter (scripts/install-packages.sh --tests), found none" >&2; exit 1; }

how=(--dry-run -Werror)
[ "${1:-}" = "--fix" ] && how=(-i)
find include library python examples src pipeline replay drivers apps tests \( -name '*.cpp' -o -name '*.h' \) -print0 | xargs -0 -n 40 -P "$(nproc)" $formatter "${how[@]}"
echo "format: as .clang-format says"
