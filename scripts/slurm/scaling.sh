#!/usr/bin/env bash
# How long the tasks of a plan would take on more nodes: scaling.sh OUT [NODES...]. Runs what is not done, one task after the other, and takes each
# one's processor time for its time on a node of one core (--sequential in the run's options makes it so). Tasks talk to nobody and Slurm starts the
# next where one ends, so that the rest is arithmetic; a shared disk that is too slow, and waiting in the queue, are not in it.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
. "$here/common.sh"
expect_plan scaling.sh "${1:-}"
out=$1
shift
nodes=("$@")
[ $# -gt 0 ] || nodes=(1 2 4 8 16 32)
for count in "${nodes[@]}"; do expect_number scaling.sh NODES "$count"; done

# COMMAND...: its processor time, s.
processor_s() {
  local TIMEFORMAT='%U %S'
  { time "$@" > "$out/scaling.log" 2>&1; } 2>&1 | awk '{ printf "%.3f", $1 + $2 }' ||
    refuse "$(cat "$out/scaling.log")"$'\n'"scaling.sh: $* failed"
}
tasks=$(wc -l < "$out/plan.tsv")
: > "$out/scaling.tsv"
# Those of --states, for which the tasks wait: a line each of `states SECONDS`, then of `task SECONDS`.
if cut -f 6 "$out/plan.tsv" | grep -qv '^-$'; then
  recordings=$(cut -f 2 "$out/plan.tsv" | uniq | wc -l)
  for ((i = 0; i < recordings; ++i)); do
    seconds=$(processor_s "$here/states.sh" "$out" "$i")
    echo "states $seconds" >> "$out/scaling.tsv"
  done
fi
for ((i = 0; i < tasks; ++i)); do
  name=$(sed -n "$((i + 1))p" "$out/plan.tsv" | cut -f 2)
  ! is_finished "$out/parts/$(part_name "$name" $i)" || refuse "scaling.sh: $out: task $i is done already; expected a new plan"
  seconds=$(processor_s "$here/task.sh" "$out" "$i")
  echo "task $seconds" >> "$out/scaling.tsv"
done
merge=$(processor_s "$here/merge.sh" "$out")
frames=$(cut -f 2 "$out/plan.tsv" | uniq | while read -r name; do tail -n +2 "$out/$name/timestamps.csv"; done | wc -l)
awk -v nodes="${nodes[*]}" -v merge="$merge" -v frames="$frames" '
  { kind[NR] = $1; time[NR] = $2; sum += $2; count[$1]++ }
  END {
    if (count["states"]) printf "%d jobs of states before them, ", count["states"]
    printf "%d tasks, %.1f s of a processor, %d frames; joined in %.1f s\n", count["task"], sum, frames, merge
    printf "%6s %10s %10s %9s\n", "nodes", "seconds", "frames/s", "speed-up"
    n = split(nodes, wanted, " ")
    for (k = 1; k <= n; ++k) {
      split("", busy)
      for (i = 1; i <= NR; ++i) {
        if (i > 1 && kind[i] != kind[i - 1]) {
          done = 0
          for (j in busy) if (busy[j] > done) done = busy[j]
          for (j = 1; j <= wanted[k]; ++j) busy[j] = done
        }
        least = 1
        for (j = 2; j <= wanted[k]; ++j) if (busy[j] + 0 < busy[least] + 0) least = j
        busy[least] += time[i]
      }
      last = 0
      for (j in busy) if (busy[j] > last) last = busy[j]
      last += merge
      if (k == 1) first = last * (wanted[k] == 1 ? 1 : 0)
      speed_up = "-"
      if (first > 0) speed_up = sprintf("%.1f", first / last)
      printf "%6d %10.1f %10.0f %9s\n", wanted[k], last, frames / last, speed_up
    }
  }' "$out/scaling.tsv"
