#!/usr/bin/env bash
# Small networks trained at equal budgets and scored alike: the tables of research/experiments.md, "Experiments".
#   scripts/experiments.sh DATA [EXPERIMENT...]     without EXPERIMENT: all of them
#   scripts/experiments.sh --tables                 only writes the tables again
# A finished run (a line of research/experiments.csv) is not repeated, so the script may be stopped at any time. A
# run's budget is MINUTES of processor time (5), simulation included. DATA as in scripts/accuracy.sh. TRAIN, PACK,
# EVENTIDE name the programs, OUT the folder of the runs (out/experiments).
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
expect_arguments 1 99 "$@"
if [ "$1" != --tables ]; then
  expect_files experiments "$1"/{recordings,images/bsds500,images/objects,images/elementary,perceptual/lpips_squeeze_v0.1.npz}
  DATA=$(realpath "$1")
fi
cd "$(dirname "$0")/.."
build=build/release/apps
train=${TRAIN:-$build/train/eventide-train}
pack=${PACK:-$build/train/eventide-pack-images}
program=${EVENTIDE:-$build/cli/eventide}
minutes=${MINUTES:-5}
expect_number experiments MINUTES "$minutes"
out=${OUT:-out/experiments}
results=research/experiments.csv
page=research/experiments.md
export GOMP_SPINCOUNT=0 OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
# An allocator that keeps memory between steps, where there is one.
jemalloc=$(ldconfig -p | awk '/libjemalloc\.so\.2/ { path = $NF } END { print path }')
keep_memory=(env ${jemalloc:+LD_PRELOAD=$jemalloc
  MALLOC_CONF=dirty_decay_ms:-1,muzzy_decay_ms:-1,narenas:4,oversize_threshold:0,thp:always})

# What every run shares: the shipped network's shape, on images small enough for hundreds of steps, and scenes short
# enough for hundreds of them: with long ones two seeds differed by .1 in SSIM.
common=(--minutes "$minutes" --clock cpu --threads 1 --streams 2 --groups 6 --crop 48 --patch 48 --event-windows 6 --rendered 3 --episode 12,60
  --widths 16,32,48,48 --mlp 64,64 --rate 0.002 --warm-up 30 --ema 0.99 --validate-minutes 100000
  --validation-scenes 8 --validation-windows 30 --validation-crop 64)

declare -A options experiments title
run() { options[$1]=${*:2}; }
experiment() { experiments[$1]=$2; title[$1]=$3; order+=("$1"); }
order=()

run base
run seed2         --seed 2
run seed3         --seed 3
run thesis        --encoder thesis --widths 24
run equal         --widths 32,32,32,32
run narrow        --widths 8,16,32,64
run half          --latent-stride 2
run levels3       --widths 16,32,48 --recurrent 1,1,1
run levels5       --widths 16,32,48,48,48 --recurrent 1,1,1,1,1
run mlp32         --mlp 32,32
run mlp128        --mlp 128,128,128,128
run full-only     --recurrent 1,0,0,0
run half-only     --recurrent 0,1,0,0
run quarter-only  --recurrent 0,0,1,0
run bins1         --bins 1
run bins2         --bins 2
run polarity      --inputs polarity
run no-moments    --inputs polarity,count,since
run no-since      --inputs polarity,mean,std,count
run threshold35   --threshold 0.35,0.35
run threshold-low --threshold 0.1,0.4
run gate12        --gate-radius 12
run gate32        --gate-radius 32
run spread4       --gate-spread 4
run cheap         --widths 8,16,32,64 --recurrent 1,0,0,0
run cheap5        --widths 8,16,32,64,64 --recurrent 1,0,0,0,0 --gate-radius 12
run l1-only       --ssim 0 --lpips-weight 0
run no-lpips      --lpips-weight 0
run no-ssim       --ssim 0
run no-temporal   --temporal 0

experiment seeds      "base seed2 seed3"                     "How far runs of the same options differ: smaller differences below say nothing"
experiment encoder    "base thesis"                    "1. The gated encoder against the thesis' (instance norm, whole-image statistics)"
experiment renderer   "base mlp32 mlp128 half"         "4. The renderer's width; latent codes at half resolution"
experiment inputs     "base bins2 bins1 no-moments no-since polarity" "6. What the voxel grid says"
experiment losses     "base no-lpips no-ssim no-temporal l1-only" "7. Losses"
experiment thresholds "base threshold-low threshold35" "8. Range of contrast thresholds in training"
experiment widths     "base equal narrow levels3 levels5" "10. Where the multiply-adds go, and field of view"
experiment gate       "base gate12 gate32 spread4"   "How far around events the state may change (4 px in base; spread4: 4 px of the lowest resolution further there)"
experiment states     "base full-only half-only quarter-only" "10b. Which levels remember"
experiment combined   "base narrow full-only cheap levels5 cheap5" "The best of 10, 10b and the gate, together"

# One line of scores from a file that eventide evaluate wrote: MSE, SSIM, LPIPS, PICP80 over everything.
scores() { awk -F, 'END { printf "%.4f,%.3f,%.3f,%.3f", $3, $4, $5, $10 }' "$1"; }

# The line of a run at a budget, where it has one.
result_of() { # RUN MINUTES
  [ ! -e "$results" ] || awk -F, -v run="$1" -v minutes="$2" '$1 == minutes && $2 == run' "$results"
}

train_and_score() {
  local name=$1 folder=$out/$1-$minutes
  [ -z "$(result_of "$name" "$minutes")" ] || return 0
  echo "experiments: $name: ${options[$name]}" >&2
  rm -rf "$folder"
  mkdir -p "$folder"
  # shellcheck disable=SC2206  # options are words
  local command=("${keep_memory[@]}" "$train" "${common[@]}" ${options[$name]} --textures "$out/train.pack"
    --validation-textures "$out/held_out.pack" --lpips "$lpips" --out "$folder")
  command+=(--export "$folder/model.safetensors")
  "${command[@]}" > "$folder/output.txt"
  local held_out steps
  # step, minutes, score, L1, 1-SSIM, LPIPS (0: a loss without it does not measure it), NLL, temporal, MSE, PICP80
  held_out=$(awk -F, 'END { printf "%.4f,%.3f,%s,%.3f", $9, $5, $6 == 0 ? "-" : sprintf("%.3f", $6), $10 }' "$folder/validation.csv")
  steps=$(awk -F, 'END { print $1 }' "$folder/validation.csv")
  local row="$name,${options[$name]//,/;},$steps,$held_out"
  if [ ! -e "$folder/model.safetensors" ]; then
    write_result "$row,-,-,-,-,-,-,-,-,-,-,-,-"
    return
  fi
  local evaluate=("$program" --quiet evaluate --model "$folder/model.safetensors" --lpips "$lpips")
  for lookahead in 0 2; do
    "${evaluate[@]}" --protocol simulated --images "$DATA/images/bsds500" --last-images 100 --sequences 4 \
      --event-windows 60 --size 120x80 --lookahead $lookahead --csv "$folder/simulated$lookahead.csv" > /dev/null
  done
  "${evaluate[@]}" "$DATA/recordings/camerashake_b" "$DATA/recordings/slider_depth_head" \
    --csv "$folder/real.csv" > /dev/null
  write_result "$row,$(scores "$folder/simulated0.csv"),$(scores "$folder/simulated2.csv"),$(scores "$folder/real.csv")"
}

header="minutes,run,options,steps"
for where in held_out simulated simulated_lookahead2 real; do
  header+=,${where}_mse,${where}_$([ $where = held_out ] && echo dssim || echo ssim),${where}_lpips,${where}_picp80
done

# Adds the line of the run at hand: whole, or not there.
write_result() {
  { if [ -e "$results" ]; then cat "$results"; else echo "$header"; fi; echo "$minutes,$1"; } > "$results.part"
  mv "$results.part" "$results"
}

# One table: the runs of an experiment that have results at a budget, where there are two or more.
write_table() { # EXPERIMENT MINUTES
  local one row rows=() how="scripts/experiments.sh DATA $1"
  for one in ${experiments[$1]}; do
    row=$(result_of "$one" "$2")
    [ -z "$row" ] || rows+=("$row")
  done
  [ ${#rows[@]} -ge 2 ] || return 0
  [ "$2" = 5 ] || how="MINUTES=$2 $how"
  printf '\n**%s**, %s minutes a run (`%s`)\n\n' "${title[$1]}" "$2" "$how"
  printf '| run | options | steps | held-out scenes | simulated | lookahead 2 | real |\n|---|---|---|---|---|---|---|\n'
  printf '%s\n' "${rows[@]}" | awk -F, '{
    gsub(";", ",", $3) # the commas of options
    printf "| %s | %s | %s |", $2, $3 == "" ? "" : "`" $3 "`", $4
    for (i = 5; i < 21; i += 4) if ($i == "-") printf " - |"; else printf " %s %s %s (%s) |", $i, $(i+1), $(i+2), $(i+3)
    print ""
  }'
}

# The part of the page between its two marks, from the results; the longest runs of an experiment first.
write_tables() {
  local text=$out/tables.md name budgets budget
  budgets=$(awk -F, 'NR > 1 { print $1 }' "$results" | sort -rnu)
  for name in "${order[@]}"; do
    for budget in $budgets; do write_table "$name" "$budget"; done
  done > "$text"
  awk -v text="$text" '
    /<!-- experiments begin -->/ { print; while ((getline line < text) > 0) print line; skip = 1 }
    /<!-- experiments end -->/ { skip = 0; print "" }
    !skip' "$page" > "$out/page.md"
  cat "$out/page.md" > "$page"
}

mkdir -p "$out"
if [ "$1" != --tables ]; then
  lpips=$DATA/perceptual/lpips_squeeze_v0.1.npz
  shift
  [ $# -gt 0 ] || set -- "${order[@]}"
  for name in "$@"; do
    [ -n "${experiments[$name]:-}" ] || refuse "experiments: expected one of ${order[*]}, found '$name'"
  done
  expect_program experiments "$train" "preset release builds it; TRAIN names another"
  expect_program experiments "$pack" "preset release builds it; PACK names another"
  expect_program experiments "$program" "preset release builds it; EVENTIDE names another"
  [ -e "$out/train.pack" ] || "$pack" "$out/train.pack" 400 "$DATA/images/objects" 0 0 "$DATA/images/elementary" 0 0
  [ -e "$out/held_out.pack" ] || "$pack" "$out/held_out.pack" 400 "$DATA/images/bsds500" 400 100
  for name in "$@"; do
    for one in ${experiments[$name]}; do train_and_score "$one"; done
    write_tables
  done
else
  write_tables
fi
