#!/usr/bin/env bash
# Measures a model: docs/accuracy/tables.md, figures beside it (their numbers in csv/), and the targets in docs/accuracy.md.
#   scripts/accuracy.sh DATA [MODEL [SECTION...]]
# DATA holds recordings/, images/bsds500/ and perceptual/lpips_squeeze_v0.1.npz; MODEL is a name or a file (default).
# SECTION: real calibration simulated sigma super-resolution silence; without: all of them.
# A section that was measured for this very model is not measured again (out/accuracy keeps them; FRESH=1 does), so the
# script may be stopped at any time. EVENTIDE names the program; else build/release/apps/cli/eventide. SEQUENCES: how
# many simulated ones (20).
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
all=(real calibration simulated sigma super-resolution silence)
expect_arguments 1 99 "$@"
expect_files accuracy "$1"/{recordings,images/bsds500,perceptual/lpips_squeeze_v0.1.npz}
DATA=$(realpath "$1")
model=${2:-default}
[ ! -f "$model" ] || model=$(realpath "$model")
cd "$(dirname "$0")/.."
shift $(($# < 2 ? $# : 2))
wanted=("$@")
[ $# -gt 0 ] || wanted=("${all[@]}")
for section in "${wanted[@]}"; do
  [[ " ${all[*]} " == *" $section "* ]] || refuse "accuracy: expected one of ${all[*]}, found '$section'"
done
program=${EVENTIDE:-build/release/apps/cli/eventide}
expect_program accuracy "$program" "preset release builds it; EVENTIDE names another"
sequences=${SEQUENCES:-20}
expect_number accuracy SEQUENCES "$sequences"
few=$(((sequences + 4) / 5))
out=docs/accuracy
file=$model
[ -e "$file" ] || file=${EVENTIDE_MODELS:-config/models}/$model.safetensors
[ -e "$file" ] || refuse "accuracy: expected a model file or its name, found '$model'"
kept=out/accuracy/$(sha256sum "$file" | cut -c 1-12)-$sequences
mkdir -p "$out" "$kept"
export EVENTIDE_EVALUATE_OVERWRITE=true  # tables and figures of an earlier call
calibrated=$kept/calibrated.safetensors

lpips=(--lpips "$DATA/perceptual/lpips_squeeze_v0.1.npz")
simulated=(--protocol simulated --images "$DATA/images/bsds500" --last-images 100)
recordings() { for name in "$@"; do echo "$DATA/recordings/$name"; done; }
mapfile -t real < <(recordings camerashake_b slider_depth_head davis346_desk)
mapfile -t held_out < <(recordings davis346_robotarm davis346_desk slider_depth_70_71)

# What is not a path of the project is shown as a name.
shown() { sed "s|$calibrated|calibrated.safetensors|g; s|$DATA|\$DATA|g; s|$file|$(basename "$file")|g"; }

# Runs one evaluation; command and table go to the section's text, the numbers to NAME.csv for the targets.
measure() { # NAME OPTIONS...
  local csv=(--csv "$kept/$1.csv")
  shift
  set -- --model "$model" "$@"
  echo "accuracy: eventide evaluate $*" | shown >&2
  "$program" evaluate "$@" "${csv[@]}" > "$kept/output.txt" 2>&1 || { cat "$kept/output.txt" >&2; exit 1; }
  { echo '```'; echo "\$ eventide evaluate $*"; cat "$kept/output.txt"; echo '```'; } | shown
}

# Makes figures; the numbers of the CSV files named go to the section's text, a column for each and each of its lines.
figures() { # TABLES... -- OPTIONS...
  local csv=()
  while [ "$1" != -- ]; do csv+=("$out/$1.csv"); shift; done
  shift
  set -- --model "$model" "$@" --plots "$out"
  echo "accuracy: eventide evaluate $*" | shown >&2
  { echo '```'; echo "\$ eventide evaluate $*"; echo '```'; } | shown
  "$program" --quiet evaluate "$@" > /dev/null
  cp "${csv[@]}" "$kept"
  printf '\n'
  awk -F, '
    FNR == 1 { name = FILENAME; sub(/.*\//, "", name); sub(/\.csv/, "", name); next }
    { column = name " " $1; if (!(column in seen)) { seen[column]; columns[++n] = column }
      if (!($2 in known)) { known[$2]; rows[++m] = $2 }
      value[$2, column] = $3 }
    END { line = "| |"; rule = "|---|"
      for (j = 1; j <= n; ++j) { line = line " " columns[j] " |"; rule = rule "---|" }
      print line; print rule
      for (i = 1; i <= m; ++i) { line = "| " rows[i] " |"
        for (j = 1; j <= n; ++j) line = line " " value[rows[i], columns[j]] " |"
        print line } }' "${csv[@]}"
}

section_real() {
  echo "## Real recordings"
  for lookahead in 0 1 2; do measure real$lookahead "${real[@]}" "${lpips[@]}" --lookahead $lookahead; done
}
section_calibration() {
  echo "## Calibration on other real recordings"
  for rule in coverage cautious; do
    measure held_out "${held_out[@]}" --skip 1 --calibration $rule --calibrated "$calibrated"
    model=$calibrated measure $rule "${real[@]:0:2}"
  done
}
section_simulated() {
  echo "## Simulated test set"
  measure simulated2 "${simulated[@]}" --sequences "$sequences" "${lpips[@]}" --lookahead 2 --plots "$out" \
    --figure events --figure sigma --figure patch-size --figure reliability
  measure simulated0 "${simulated[@]}" --sequences "$sequences" "${lpips[@]}" --lookahead 0
  measure simulated1 "${simulated[@]}" --sequences $few "${lpips[@]}" --lookahead 1
}
# Between the edges of event windows and between pixels several codes are blended, and the rules for sigma differ.
section_sigma() {
  echo "## Blended ln sigma against mixture variance"
  for rule in log_blend mixture; do
    measure real_$rule "${real[@]}" --lookahead 2 --window 50ms --sigma-rule $rule
    measure simulated_$rule "${simulated[@]}" --sequences $few --lookahead 2 --scale 1.5 --sigma-rule $rule
  done
}
# Frames six times the sensor's size: a smaller sensor, fewer event windows.
section_super-resolution() {
  echo "## Super-resolution in space and time"
  figures spatial_lpips spatial_mse spatial_ssim -- "${simulated[@]}" "${lpips[@]}" --lookahead 2 --sequences $few \
    --event-windows 40 --size 120x80 --figure spatial
  figures temporal_lpips temporal_mse temporal_ssim -- "${simulated[@]}" "${lpips[@]}" --lookahead 2 --sequences $few \
    --event-windows 40 --size 120x80 --figure temporal
}
section_silence() {
  echo "## A scene that stops"
  figures silence_mse silence_sigma silence_change -- "${simulated[@]}" "${lpips[@]}" --lookahead 2 \
    --sequences $few --figure silence
}

for section in "${wanted[@]}"; do
  part=$kept/$section.md
  [ -e "$part" ] && [ -z "${FRESH:-}" ] && continue
  "section_$section" > "$part.part"
  mv "$part.part" "$part"
done

{
  echo "# Tables of $(basename "$model" .safetensors), written by scripts/accuracy.sh"
  for section in "${all[@]}"; do
    [ ! -e "$kept/$section.md" ] || { echo; cat "$kept/$section.md"; }
  done
} > "$out/tables.md"

# The targets of docs/accuracy.md, each against what was measured; nothing where its section is not there yet.
# "all" of a single sequence is that one.
cell() { awk -F, -v s="$2" -v c="$3" '$1 == s || (s == "all" && NR == 2) { v = $c } END { print v }' "$kept/$1.csv" 2>/dev/null || true; }
point() { awk -F, -v s="$2" -v x="$3" '$1 == s && $2 == x { print $3 }' "$kept/$1.csv" 2>/dev/null || true; }
target() { # TEXT LOWEST HIGHEST FOUND
  awk -v text="$1" -v low="$2" -v high="$3" -v found="$4" 'BEGIN {
    asked = low == "" ? "at most " high : high == "" ? "at least " low : low " to " high
    ok = found != "" && (low == "" || found >= low + 0) && (high == "" || found <= high + 0)
    printf "| %s | %s | %s | %s |\n", text, asked, found == "" ? "not measured" : sprintf("%.3g", found),
      found == "" ? "" : ok ? "yes" : "**no**" }'
}
difference() { awk -v a="$1" -v b="$2" 'BEGIN { if (a != "" && b != "") print a - b }'; }
ratio() { awk -v a="$1" -v b="$2" 'BEGIN { if (a != "" && b != "") print a / b }'; }
targets() {
  local mse=3 ssim=4 lpips=5 picp80=10 ll=11 name
  printf '| measure | target | measured | met |\n|---|---|---|---|\n'
  target "simulated, $sequences sequence$([ "$sequences" -eq 1 ] || echo s), lookahead 2: MSE" "" .018 "$(cell simulated2 all $mse)"
  target "the same: SSIM" .65 "" "$(cell simulated2 all $ssim)"
  target "the same: PICP80" .77 .83 "$(cell simulated2 all $picp80)"
  target "the same: LL" .76 "" "$(cell simulated2 all $ll)"
  target "MSE at lookahead 0 over that at lookahead 2" "" 1.15 "$(ratio "$(cell simulated0 all $mse)" "$(cell simulated2 all $mse)")"
  # Baselines are known per recording (docs/accuracy.md), so the two weigh equally.
  both() { awk -v a="$(cell real0 camerashake_b "$1")" -v b="$(cell real0 slider_depth_head "$1")" \
    'BEGIN { if (a != "" && b != "") print (a + b) / 2 }'; }
  target "camerashake_b and slider_depth_head, raw, mean of the two: MSE" "" .04 "$(both $mse)"
  target "the same: SSIM (best baseline: FireNet, .458)" .458 "" "$(both $ssim)"
  target "the same: LPIPS-Squeeze (best baseline: PIE-Net-Lite, .292)" "" .29 "$(both $lpips)"
  target "camerashake_b alone: SSIM (best baseline: FireNet, .510)" .51 "" "$(cell real0 camerashake_b $ssim)"
  target "the same: LPIPS-Squeeze (FireNet, .250)" "" .25 "$(cell real0 camerashake_b $lpips)"
  target "slider_depth_head alone: SSIM (best baseline: PIE-Net-Lite, .490)" .49 "" "$(cell real0 slider_depth_head $ssim)"
  target "the same: LPIPS-Squeeze (PIE-Net-Lite, .280)" "" .28 "$(cell real0 slider_depth_head $lpips)"
  for name in camerashake_b slider_depth_head; do
    target "$name: PICP80 after calibration on other recordings" .7 .9 "$(cell cautious $name $picp80)"
  done
  for scale in 1.5 2 3 4; do
    target "$scale times the size: LPIPS less that of cubic" "" 0 \
      "$(difference "$(point spatial_lpips model $scale)" "$(point spatial_lpips cubic $scale)")"
  done
  target "6000 silent event windows: change of intensity" "" .01 "$(point silence_change model 6000)"
  target "the same: sigma over that at the stop" 1 "" \
    "$(ratio "$(point silence_sigma model 6000)" "$(point silence_sigma model 0)")"
}
targets > "$kept/targets.md"
awk -v text="$kept/targets.md" '
  /<!-- targets begin -->/ { print; while ((getline line < text) > 0) print line; skip = 1 }
  /<!-- targets end -->/ { skip = 0 }
  !skip' docs/accuracy.md > "$kept/page.md"
cat "$kept/page.md" > docs/accuracy.md
mkdir -p "$out/csv"
for numbers in "$out"/*.csv; do [ ! -e "$numbers" ] || mv "$numbers" "$out/csv"; done
echo "accuracy: $out/tables.md" >&2
times > "$kept/times" # of this shell, then of what it ran: user, system
awk 'NR == 2 { print "accuracy: " $1 " + " $2 " of processor time" }' "$kept/times" >&2
