#!/usr/bin/env bash
# One task of a plan: task.sh OUT [NUMBER]; the number, from 0, is else $SLURM_ARRAY_TASK_ID. What is done already is left as it is; what a killed
# task left is made anew, beside its place, and renamed when it is whole.
set -euo pipefail
. "$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/common.sh"
take_job task.sh "$@"
IFS=$'\t' read -r recording name from to before state < <(sed -n "$((number + 1))p" "$out/plan.tsv") ||
  refuse "task.sh: $out/plan.tsv: expected task $number, found $(counted "$(wc -l < "$out/plan.tsv")" task)"
part=$out/parts/$(part_name "$name" "$number")
if is_finished "$part"; then
  echo "$part: done before" >&2
  exit 0
fi

# Frames wait for event windows behind their own: a second more, of which merge.sh keeps nothing.
if [ "$state" != - ]; then
  state=$(state_file "$out" "$number")
  [ -e "$state" ] || refuse "task.sh: expected $state (states.sh $out makes it), found none"
  options+=(--from "@$from" --state-in "$state")
elif [ "$from" != - ]; then
  options+=(--from "@$from" --warmup "${before}us")
fi
[ "$to" = - ] || options+=(--to "@$((to + 1000000))")
work=$part.$(hostname).$$.work
rm -rf "$part".*.work "$part"
"$EVENTIDE" run "$recording" "${options[@]}" --out "$work/"
is_finished "$work" || refuse "task.sh: $work: expected a finished run"
mv -T "$work" "$part"
