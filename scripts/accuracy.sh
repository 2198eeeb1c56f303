#!/usr/bin/env bash
# Measures a model and writes docs/accuracy/: tables.md, and figures as SVG and CSV. Ten minutes to an hour.
#   scripts/accuracy.sh DATA [MODEL]
# DATA holds recordings/, images/bsds500/ and perceptual/lpips_squeeze_v0.1.npz; MODEL is a name or a file (default).
# EVENTIDE names the program; else build/release/src/app/eventide. SEQUENCES: how many simulated ones (20).
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -ge 1 ] || { sed -n '2,6s/^# \{0,1\}//p' "$0" >&2; exit 2; }
DATA=$1
model=${2:-default}
program=${EVENTIDE:-build/release/src/app/eventide}
sequences=${SEQUENCES:-20}
few=$(((sequences + 2) / 3))
out=docs/accuracy
mkdir -p "$out"
tables=$out/tables.md
scratch=$(mktemp -d)
calibrated=$scratch/calibrated.safetensors
trap 'rm -r "$scratch"' EXIT

lpips=(--lpips "$DATA/perceptual/lpips_squeeze_v0.1.npz")
simulated=(--protocol simulated --images "$DATA/images/bsds500" --last-images 100)
recordings() { for name in "$@"; do echo "$DATA/recordings/$name"; done; }

# Runs one evaluation and keeps command and table; what is not a path of the project is shown as $DATA.
measure() {
  local shown="$*"
  shown=${shown//$DATA/\$DATA}
  shown=${shown//$calibrated/calibrated.safetensors}
  echo "accuracy: eventide evaluate $shown" >&2
  { echo '```'; echo "\$ eventide evaluate $shown"; "$program" evaluate "$@" 2>&1; echo '```'; } \
    | sed "s|$calibrated|calibrated.safetensors|; s|$DATA|\$DATA|g" >> "$tables"
}
title() { printf '\n## %s\n' "$1" >> "$tables"; }

echo "# Tables of $model, written by scripts/accuracy.sh" > "$tables"

title "Real recordings"
real=($(recordings camerashake_b slider_depth_head davis346_desk))
for lookahead in 0 1 2; do
  measure "${real[@]}" --model "$model" "${lpips[@]}" --lookahead $lookahead
done
# Between the edges of event frames several codes are blended, and the rules for sigma differ.
for rule in log_blend mixture; do
  measure "${real[@]}" --model "$model" "${lpips[@]}" --lookahead 2 --window 50ms --sigma-rule $rule
done

title "Calibration on other real recordings"
held_out=($(recordings davis346_robotarm davis346_desk slider_depth_70_71))
measure "${held_out[@]}" --model "$model" "${lpips[@]}" --skip 1 --calibrated "$calibrated"
measure "${real[@]:0:2}" --model "$model" "${lpips[@]}"
measure "${real[@]:0:2}" --model "$calibrated" "${lpips[@]}"

title "Simulated test set"
for lookahead in 0 1 2; do
  measure "${simulated[@]}" --sequences "$sequences" --model "$model" "${lpips[@]}" --lookahead $lookahead
done
for rule in log_blend mixture; do
  measure "${simulated[@]}" --sequences $few --model "$model" "${lpips[@]}" --lookahead 2 --scale 1.5 --sigma-rule $rule
done

for figure in events sigma patch-size reliability temporal silence; do
  "$program" --quiet evaluate "${simulated[@]}" --model "$model" "${lpips[@]}" \
    --lookahead 2 --sequences $few --figure $figure --plots "$out"
done
# Pictures six times the sensor's size: a smaller sensor, fewer of them.
"$program" --quiet evaluate "${simulated[@]}" --model "$model" "${lpips[@]}" \
  --lookahead 2 --sequences $few --event-frames 60 --size 120x80 --figure spatial --plots "$out"
echo "accuracy: $tables" >&2
