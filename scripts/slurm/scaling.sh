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

# COMMAND...: its processor time, s.
processor_s() {
  local TIMEFORMAT='%U %S'
  { time "$@" > "$out/scaling.log" 2>&1; } 2>&1 | awk '{ printf "%.3f", $1 + $2 }'
}
tasks=$(wc -l < "$out/plan.tsv")
: > "$out/scaling.tsv"
for ((i = 0; i < tasks; ++i)); do
  name=$(sed -n "$((i + 1))p" "$out/plan.tsv" | cut -f 2)
  ! is_finished "$out/parts/$(part_name "$name" $i)" || refuse "scaling.sh: $out: task $i is done already; expected a new plan"
  processor_s "$here/task.sh" "$out" "$i" >> "$out/scaling.tsv"
  echo >> "$out/scaling.tsv"
done
merge=$(processor_s "$here/merge.sh" "$out")
frames=$(cut -f 2 "$out/plan.tsv" | uniq | while read -r name; do tail -n +2 "$out/$name/timestamps.csv"; done | wc -l)
awk -v nodes="${nodes[*]}" -v merge="$merge" -v frames="$frames" '
  { time[NR] = $1; sum += $1 }
  END {
    printf "%d tasks, %.1f s of a processor, %d frames; joined in %.1f s\n", NR, sum, frames, merge
    printf "%6s %10s %10s %9s\n", "nodes", "seconds", "frames/s", "speed-up"
    n = split(nodes, wanted, " ")
    for (k = 1; k <= n; ++k) {
      split("", busy)
      for (i = 1; i <= NR; ++i) {
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
