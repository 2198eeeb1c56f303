#!/usr/bin/env bash
# Trains the default network (MODEL=small: the small one; MODEL=default_up, small_up: those with their way down as it is) on, from its committed checkpoint, and writes the checkpoint anew.
#   scripts/train.sh DATA MINUTES [OPTIONS]     DATA as in scripts/accuracy.sh; MINUTES of wall clock, from now on;
# OPTIONS of eventide-train, which the checkpoint keeps.
# One thread at low priority, at the full learning rate (CONSTANT=.6: it falls in the last two fifths of all minutes so
# far, for a model to ship: OUT/model.safetensors). Ctrl-C ends it after the step at hand with everything written.
# TRAIN, PACK name the programs, OUT the folder of the run (out/train; with MODEL out/MODEL), PACKS that of the photographs, packed (out/train).
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
expect_arguments 2 999 "$@"
expect_number train MINUTES "$2"
expect_files train "$1/perceptual/lpips_squeeze_v0.1.npz"
data=$(realpath "$1")
cd "$(dirname "$0")/.."
build=build/release/apps/train
train=${TRAIN:-$build/eventide-train}
pack=${PACK:-$build/eventide-pack-images}
out=${OUT:-out/${MODEL:-train}}
packs=${PACKS:-out/train}
checkpoint=config/models/checkpoints/${MODEL:-default}.safetensors
expect_files train "$checkpoint"
expect_program train "$train" "preset release builds it; TRAIN names another"
expect_program train "$pack" "preset release builds it; PACK names another"
mkdir -p "$out" "$packs"
[ -e "$packs/train.pack" ] || "$pack" "$packs/train.pack" 400 "$data/images/photos" 0 0 "$data/images/objects" 0 0 "$data/images/elementary" 0 0 "$data/images/bsds500" 0 400
[ -e "$packs/held_out.pack" ] || "$pack" "$packs/held_out.pack" 400 "$data/images/bsds500" 400 100
ln -sf "$(realpath "$data/perceptual/lpips_squeeze_v0.1.npz")" "$out/lpips_squeeze_v0.1.npz"

# What the run has had, so that MINUTES are added to it.
had=$(head -c 100000 "$checkpoint" | grep -ao '"elapsed_minutes":"[^"]*"' | cut -d'"' -f4)
minutes=$(awk "BEGIN { print $(printf '%.3f' "0x$had") + $2 }")
export GOMP_SPINCOUNT=0 OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
jemalloc=$(ldconfig -p | awk '/libjemalloc\.so\.2/ { path = $NF } END { print path }')
exec nice -n 10 env ${jemalloc:+LD_PRELOAD=$jemalloc MALLOC_CONF=dirty_decay_ms:20000,muzzy_decay_ms:20000,narenas:4,oversize_threshold:0,thp:always} \
  "$train" --resume "$checkpoint" --minutes "$minutes" --steps 0 --clock wall --constant-share "${CONSTANT:-.999}" \
  --checkpoint-minutes 10 --validate-minutes 20 --validation-scenes 24 --out "$out" --keep "$checkpoint" --export "$out/model.safetensors" --overwrite 1 \
  --textures "$packs/train.pack" --validation-textures "$packs/held_out.pack" --lpips "$out/lpips_squeeze_v0.1.npz" "${@:3}"
