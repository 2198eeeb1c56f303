#!/usr/bin/env bash
# What weighing by sigma gives examples/tracker.cpp as noise grows (docs/library.md has the table): scenes with known motion, to which so many
# random events per pixel and second are added, the same each time.
#   EVENTIDE=eventide scripts/tracker_noise.sh TRACKER ['SCENE SEED'...]
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
expect_arguments 1 99 "$@"
eventide=${EVENTIDE:-eventide}
tracker=$1
shift
expect_program tracker_noise "$eventide" "EVENTIDE names another"
expect_program tracker_noise "$tracker" "made of examples/tracker.cpp"
scenes=("$@")
[ $# -gt 0 ] || scenes=("thesis_test 11" "thesis_test 12" "thesis_train 11" "thesis_train 12" "wide 13" "demo 13")
size=240x180 seconds=3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# HZ: random events of a sensor of that size in rows of t (us), x, y, p, in order of time.
noise() {
  awk -v hz="$1" -v size=$size -v seconds=$seconds 'BEGIN {
    srand(7); split(size, side, "x"); n = hz * side[1] * side[2] * seconds
    for (i = 0; i < n; ++i) { t += -log(1 - rand()) * seconds * 1e6 / n; printf "%d %d %d %d\n", t, rand() * side[1], rand() * side[2], rand() * 2 }
  }'
}

printf '%-16s %9s  %s\n' 'scene, seed' 'Hz/pixel' 'median, rms in px of: equal weights | steps | 1/sigma^2 | RANSAC'
for scene in "${scenes[@]}"; do
  read -r name seed <<< "$scene"
  "$eventide" simulate --scene "$name" --seed "$seed" --seconds $seconds --size $size --images-per-second 0 --out "$work/clean.aedat4" \
    --truth "$work/truth/" --truths-per-second 50 --overwrite --quiet
  # In whole microseconds, as the recording itself has them; sorted, so that the noise lies between.
  "$eventide" convert "$work/clean.aedat4" - --to-format text --quiet | awk 'NF == 4 { printf "%d %d %d %d\n", $1 * 1e6 + .5, $2, $3, $4 }' > "$work/clean.us"
  for hz in 0 2 10; do
    { echo "${size/x/ }"; sort -n -s -k 1,1 -m "$work/clean.us" <(noise $hz); } > "$work/noisy.txt"
    "$eventide" convert "$work/noisy.txt" "$work/noisy.aedat4" --input-time-unit us --overwrite --quiet
    printf '%-16s %9s  ' "$name $seed" $hz
    # Of each way to weigh: median and rms.
    "$tracker" "$work/noisy.aedat4" "$work/truth/" 2> /dev/null |
      awk '/^(equal weights|steps|1\/sigma\^2|RANSAC)/ { printf "%s%s, %s", (n++ ? " | " : ""), $(NF - 2), $NF } END { print "" }'
  done
done
