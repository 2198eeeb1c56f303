#!/usr/bin/env bash
# What the tasks of a plan with --states begin with: states.sh OUT [NUMBER], of its recordings from 0; the number is else $SLURM_ARRAY_TASK_ID. Sees a
# recording's events once and renders nothing. What is done already is left as it is, as task.sh does it.
set -euo pipefail
. "$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/common.sh"
take_job states.sh "$@"
name=$(cut -f 2 "$out/plan.tsv" | uniq | sed -n "$((number + 1))p")
[ -n "$name" ] || refuse "states.sh: $out/plan.tsv: expected recording $number, found $(cut -f 2 "$out/plan.tsv" | uniq | wc -l)"
recording= times=()
while IFS=$'\t' read -r path whole _ _ _ state; do
  [ "$whole" = "$name" ] && [ "$state" != - ] || continue
  recording=$path
  times+=(--states-at "@$state")
done < "$out/plan.tsv"
states=$out/states/$name
if [ ${#times[@]} -eq 0 ] || [ -d "$states" ]; then
  echo "$name: nothing to do" >&2
  exit 0
fi

# By number: the name of another recording may begin as this one's does.
work=$out/states/$number.$(hostname).$$.work
rm -rf "$out/states/$number".*.work
"$EVENTIDE" run "$recording" "${options[@]}" --states-out "$work/" "${times[@]}"
mv -T "$work" "$states"
