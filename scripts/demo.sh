#!/usr/bin/env bash
# From a fresh Debian 12 to video from events: installs what is missing, builds, simulates a recording, reconstructs it.
#   scripts/demo.sh [FOLDER]         the result goes to out/demo unless told otherwise
# Makes frames as PNG, sigma as TIFF, an MP4, and one contact sheet: events, intensity, sigma and truth side by side.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
expect_arguments 0 1 "$@"
[[ ${1:-} != -* ]] || refuse "demo: expected a folder, found '$1'"
out=${1:+$(realpath -m "$1")}
cd "$(dirname "$0")/.."
out=${out:-out/demo}

scripts/install-packages.sh
echo "building (preset release) ..."
cmake --preset release >/dev/null
cmake --build --preset release --target eventide
eventide=build/release/apps/cli/eventide

mkdir -p "$out"
echo "simulating a camera before a moving scene ..."
"$eventide" simulate --scene demo --seconds 4 --size 240x180 --overwrite --out "$out/recording.aedat4"
"$eventide" info "$out/recording.aedat4"
echo "reconstructing it, from events alone ..."
"$eventide" run "$out/recording.aedat4" --frames ignore --fps 60 --overwrite \
  --out "$out/reconstruction/" --out "$out/reconstruction.mp4" --uncertainty side
"$eventide" run "$out/recording.aedat4" --frames ignore --window aps --overwrite --out "contact-sheet:$out/contact_sheet.png" --quiet
echo
echo "frames:         $out/reconstruction/frames/"
echo "sigma:          $out/reconstruction/uncertainty/"
echo "video:          $out/reconstruction.mp4   (intensity left, sigma right)"
echo "contact sheet:  $out/contact_sheet.png    (events, intensity, sigma, truth)"
