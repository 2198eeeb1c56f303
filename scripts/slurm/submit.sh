#!/usr/bin/env bash
# Reconstructs recordings as an array job of Slurm, or prepares it for other hands (--plan).
#   scripts/slurm/submit.sh [--plan] [--segment SECONDS] [--warmup SECONDS|all | --states] [--sbatch 'OPTIONS'] OUT RECORDING... [-- RUN OPTIONS]
# OUT/NAME gets what `eventide run RECORDING --out OUT/NAME/` writes (docs/services.md). Run it again to do what is missing.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
. "$here/common.sh"

plan_only=false segment= warmup=all states=false sbatch_options=
while [[ ${1:-} == --* && $1 != -- ]]; do
  case $1 in
    --plan) plan_only=true ;;
    --segment) segment=$(whole_number --segment "${2:-}"); shift ;;
    --warmup) warmup=${2:-}; [[ $warmup == all ]] || warmup=$(whole_number --warmup "$warmup"); shift ;;
    --states) states=true ;;
    --sbatch)
      [ $# -ge 2 ] || refuse "submit.sh: --sbatch: expected options of sbatch, found none"
      sbatch_options=$2
      shift
      ;;
    *) refuse "submit.sh: unknown option $1" ;;
  esac
  shift
done
! $states || [ "$warmup" = all ] || refuse "submit.sh: --states and --warmup $warmup: expected one of them"
! $states || [ -n "$segment" ] || refuse "submit.sh: --states: expected --segment SECONDS, found none"
[ $# -ge 2 ] || refuse "submit.sh: expected OUT and at least one RECORDING"
out=${1%/}
shift
recordings=()
while [ $# -gt 0 ] && [ "$1" != -- ]; do recordings+=("$1"); shift; done
[ "${1:-}" != -- ] || shift
for option in "$@"; do
  case $option in
    --out* | -o* | --from* | --to* | --duration* | --warmup* | --state* | --overwrite* | --config*)
      refuse "submit.sh: $option: the tasks set that themselves" ;;
  esac
done

ignores_images=false
[[ " $* " != *" --frames ignore "* && " $* " != *" --frames=ignore "* && ${EVENTIDE_RUN_FRAMES:-} != ignore ]] || ignores_images=true

# One line per task: recording, name, from and to (us of the sensor; - for the recording's own), length of the warm-up (us), time of the state that it
# begins with (us; - for none): a second before its part, for the network's latest maps, which a state does not hold.
new=$(mktemp)
trap 'rm -f "$new" "$new.options"' EXIT
declare -A taken
for recording in "${recordings[@]}"; do
  [ -e "$recording" ] || refuse "submit.sh: $recording: no such recording"
  name=$(basename "$recording"); name=${name%.*}
  [[ $recording != *$'\t'* && $recording != *$'\n'* ]] || refuse "submit.sh: $recording: names with tabs or line ends cannot be planned"
  [ -z "${taken[$name]:-}" ] || refuse "submit.sh: $recording and ${taken[$name]}: both would be OUT/$name"
  taken[$name]=$recording
  path=$(realpath "$recording")
  if [ -z "$segment" ]; then
    printf '%s\t%s\t-\t-\t0\t-\n' "$path" "$name" >> "$new"
    continue
  fi
  info=$("$EVENTIDE" info "$recording" --json) || refuse "submit.sh: $recording: cannot be read"
  # As run says where the states are made, but before there is a plan.
  if $states && ! $ignores_images && [ "$(number_in "$info" frames)" != 0 ]; then
    refuse "submit.sh: --states: $recording has images, which would correct frames; expected --frames ignore among the options of run"
  fi
  if [[ $(number_in "$info" clock_resets) != 0 ]]; then
    refuse "submit.sh: --segment: the clock of $recording began anew within it, so that its times do not tell the segments; leave out --segment, or convert it to .raw or .txt, in which times go on"
  fi
  # Frames count from just before the first event, as of one run.
  first=$(($(number_in "$info" first_us) - 1)) last=$(number_in "$info" last_us)
  for ((from = first; from <= last; from += segment * 1000000)); do
    before=$((from - first))
    [[ $warmup == all ]] || before=$((before < warmup * 1000000 ? before : warmup * 1000000))
    begin=$from
    [ "$from" -gt "$first" ] || begin=-
    state=-
    if $states && [ "$before" -gt 1000000 ]; then state=$((from - 1000000)) before=0; fi
    printf '%s\t%s\t%s\t%s\t%s\t%s\n' "$path" "$name" "$begin" $((from + segment * 1000000)) "$before" "$state" >> "$new"
  done
done
# Without images frames are the same, but run asks for it.
! $states || $ignores_images || set -- "$@" --frames ignore
if [ "$(wc -l < "$new")" -gt 1 ]; then
  for option in "$@"; do
    case $option in --record* | --stats* | --events-out*) refuse "submit.sh: $option: every task would write to the same" ;; esac
  done
fi
printf '%s\0' "$@" > "$new.options"
[ $# -gt 0 ] || : > "$new.options"

mkdir -p "$out/parts"
if [ -e "$out/plan.tsv" ]; then
  cmp -s "$new" "$out/plan.tsv" && cmp -s "$new.options" "$out/options" ||
    refuse "submit.sh: $out: holds another plan; expected the same recordings, segments and options, or another folder"
else
  cp "$new.options" "$out/options"
  cp "$new" "$out/plan.tsv.part" && mv "$out/plan.tsv.part" "$out/plan.tsv"
fi
tasks=$(wc -l < "$out/plan.tsv")
echo "$(counted "$tasks" task) in $out/plan.tsv" >&2
$plan_only && exit 0

out=$(realpath "$out")
# Slurm runs a copy of a script, which would not find the others: what it runs is one line that calls ours.
# What waits for a job that failed ends with it, as it would wait for ever.
# SCRIPT SBATCH-OPTION...
submit() {
  local line
  printf -v line 'exec %q %q' "$here/$1" "$out"
  # shellcheck disable=SC2086  # options of sbatch are words
  sbatch --parsable --job-name="eventide-$1" --open-mode=append --kill-on-invalid-dep=yes $sbatch_options "${@:2}" --wrap "$line"
}
after=()
if $states; then
  recordings=$(cut -f 2 "$out/plan.tsv" | uniq | wc -l)
  job=$(submit states.sh --array="0-$((recordings - 1))" --output="$out/states-%a.log")
  after=(--dependency="afterok:$job")
fi
job=$(submit task.sh --array="0-$((tasks - 1))" --output="$out/task-%a.log" "${after[@]}")
submit merge.sh --dependency="afterok:$job" --output="$out/merge.log" > /dev/null
echo "job $job, and a job behind it that joins the parts" >&2
