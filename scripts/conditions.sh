#!/usr/bin/env bash
# How good a model is in fast motion, in the dark and in glare: simulates cameras under each condition and writes the table of
# docs/accuracy.md, or prints it for another MODEL than the default.
#   scripts/conditions.sh DATA [MODEL]
# DATA holds images/bsds500/, whose last 100 photographs no shipped model was trained on, and
# perceptual/lpips_squeeze_v0.1.npz; MODEL is a name or a file (default). EVENTIDE names the program; else
# build/release/apps/cli/eventide. SEEDS: how many scenes for each condition (4). Recordings are kept in out/conditions, and used
# again where the same program would simulate the same.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
expect_arguments 1 2 "$@"
expect_files conditions "$1"/{images/bsds500,perceptual/lpips_squeeze_v0.1.npz}
DATA=$(realpath "$1")
model=${2:-default}
[ ! -f "$model" ] || model=$(realpath "$model")
cd "$(dirname "$0")/.."
program=${EVENTIDE:-build/release/apps/cli/eventide}
expect_program conditions "$program" "preset release builds it; EVENTIDE names another"
seeds=${SEEDS:-4}
expect_number conditions SEEDS "$seeds"
kept=out/conditions
rm -rf "$kept/photographs" # those of another DATA
mkdir -p "$kept/photographs"
find "$DATA/images/bsds500" -type f | sort | tail -100 | while read -r file; do
  ln -s "$(realpath "$file")" "$kept/photographs/"
done
made_of=$(cat "$(command -v "$program")" "$kept/photographs"/* | cksum)

# Beside a recording a file NAME.made says what it was made of.
simulate() { # NAME OPTIONS...
  local name=$1 made
  shift
  made="$made_of $*"
  [ "$(cat "$name.made" 2>/dev/null)" != "$made" ] || return 0
  rm -rf "$name"
  "$program" --quiet simulate "$@" --textures "$kept/photographs" --out "$name/" >&2
  echo "$made" > "$name.made"
}

# One row: all scenes of a condition, as one table's last line.
row() { # TEXT OPTIONS OF SIMULATE...
  local text=$1 name recordings=() seed
  shift
  for seed in $(seq "$seeds"); do
    name=$kept/$(echo "$*" | tr -d ' -')_$seed
    simulate "$name" --scene camera --seed "$seed" "$@" --seconds 2 --images-per-second 20
    recordings+=("$name")
  done
  echo "conditions: $text" >&2
  "$program" --quiet evaluate "${recordings[@]}" --model "$model" --window auto --lpips "$DATA/perceptual/lpips_squeeze_v0.1.npz" \
    --csv - | awk -F, -v text="$text" -v events="$(cat "${recordings[@]/%//events.txt}" | wc -l)" -v seconds=$((2 * seeds)) '
    $1 == "all" || NR == 2 { last = $0 } END { split(last, c, ",")
      printf "| %s | %.2f | %.4f %.3f %.3f | %.4f %.3f %.3f | %.2f | %.2f |\n", text, events / seconds / 1e6,
        c[3], c[4], c[5], c[6], c[7], c[8], c[10], c[11] }'
}

table() {
  echo "| condition | million events/s | raw MSE SSIM LPIPS | after an affine fit | PICP80 | LL |"
  echo "|---|---:|---|---|---|---|"
  row "100 px/s, 100 lux"
  for speed in 10 30 300 1000; do row "$speed px/s" --speed $speed; done
  row "3000 px/s: the bus is full" --speed 3000
  for lux in 10000 10 3 1 0.3 0.1; do row "$lux lux" --lux $lux; done
  for lamp in 10 1000; do row "a lamp $lamp times as bright as white" --lamp $lamp; done
  row "1000 px/s, 3 lux" --speed 1000 --lux 3
}
if [ "$model" != default ]; then
  table
  exit
fi
table > "$kept/table.md"
awk -v text="$kept/table.md" '
  /<!-- conditions begin -->/ { print; while ((getline line < text) > 0) print line; skip = 1 }
  /<!-- conditions end -->/ { skip = 0 }
  !skip' docs/accuracy.md > "$kept/page.md"
cat "$kept/page.md" > docs/accuracy.md
