#!/usr/bin/env bash
# Joins the parts of a plan: merge.sh OUT. OUT/NAME is then what one run of all would have written; parts stay, their images are the same files (hard
# links). Nothing is joined before every part is there, and what was joined before is left as it is.
set -euo pipefail
. "$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/common.sh"
out=${1:?merge.sh: expected OUT, the folder of a plan}
[ -e "$out/plan.tsv" ] || refuse "merge.sh: $out: expected plan.tsv (submit.sh makes it), found none"

missing=()
number=0
while IFS=$'\t' read -r _ name _; do
  is_finished "$out/parts/$(part_name "$name" $number)" || missing+=("$number")
  number=$((number + 1))
done < "$out/plan.tsv"
[ ${#missing[@]} -eq 0 ] || refuse "merge.sh: $out: tasks ${missing[*]} are not done (task.sh $out NUMBER does one)"

# PART TO: the lines of timestamps.csv before `to` become lines of the whole, with images under new numbers.
take_part() {
  local part=$1 to=$2 line rest frame index t seconds new old events=0
  [ ! -d "$part/events" ] || events=1
  paste -d '|' <(tail -n +2 "$part/timestamps.csv") "$part/timestamps.txt" > "$work/lines"
  while IFS='|' read -r line seconds; do
    IFS=, read -r frame index t rest <<< "$line"
    [ "$to" = - ] || [ "$t" -lt "$to" ] || break
    printf -v old '%010d' "$frame"
    printf -v new '%010d' "$count"
    ln "$part/frames/frame_$old.png" "$work/frames/frame_$new.png"
    [ ! -e "$part/uncertainty/unc_$old.tiff" ] || ln "$part/uncertainty/unc_$old.tiff" "$work/uncertainty/unc_$new.tiff"
    [ $events = 0 ] || ln "$part/events/events_$old.png" "$work/events/events_$new.png"
    echo "$count,$((base + index)),$t,$rest" >> "$work/timestamps.csv"
    echo "$seconds" >> "$work/timestamps.txt"
    count=$((count + 1)) last_index=$((base + index))
  done < "$work/lines"
  rm "$work/lines"
}

cut -f 2 "$out/plan.tsv" | uniq | while read -r whole; do
  if is_finished "$out/$whole"; then
    echo "$out/$whole: done before" >&2
    continue
  fi
  work=$out/$whole.$$.work
  rm -rf "$out/$whole".*.work
  mkdir -p "$work/frames"
  number=0 count=0 base=0 last_index=-1
  while IFS=$'\t' read -r _ name _ to _; do
    part=$out/parts/$(part_name "$name" $number)
    number=$((number + 1))
    [ "$name" = "$whole" ] || continue
    [ -e "$work/timestamps.csv" ] || head -n 1 "$part/timestamps.csv" > "$work/timestamps.csv"
    for kind in uncertainty events; do [ ! -d "$part/$kind" ] || mkdir -p "$work/$kind"; done
    base=$((last_index + 1))
    take_part "$part" "$to"
  done < "$out/plan.tsv"
  printf '{\n  "program": "scripts/slurm/merge.sh",\n  "frames": %d,\n  "parts": "%s",\n  "finished": true\n}\n' "$count" "parts/$whole.*" > "$work/run.json"
  [ ! -e "$out/$whole" ] || refuse "merge.sh: $out/$whole: something else is there; expected nothing"
  mv -T "$work" "$out/$whole"
  echo "$out/$whole: $count frames" >&2
done
