#!/usr/bin/env bash
# Makes README's animation: events, frame and sigma of a recording, in slow motion, as animated WebP.
#   scripts/moving_picture.sh RECORDING OUT.webp [FROM]     davis346_robotarm.aedat4 docs/robotarm.webp 40ms
# EVENTIDE names the program (build/release/apps/cli/eventide).
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
expect_arguments 2 3 "$@"
program=${EVENTIDE:-$(dirname "$0")/../build/release/apps/cli/eventide}
expect_program moving_picture "$program" "preset release builds it; EVENTIDE names another"
expect_program moving_picture ffmpeg "scripts/install-packages.sh --tests"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$program" run "$1" --from "${3:-0s}" --window 5ms --fps 10 --slow 30 --size .8x \
  --events --uncertainty side --out "$folder/video.mp4" --video-crf 10
ffmpeg -nostdin -v error -n -i "$folder/video.mp4" -c:v libwebp_anim -quality 55 -loop 0 "$2"
