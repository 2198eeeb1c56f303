# What the scripts of this folder share; they source it.
# shellcheck shell=bash
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
EVENTIDE=${EVENTIDE:-eventide}

# NUMBER THING: "1 task", "2 tasks".
counted() {
  echo "$1 $2$([ "$1" = 1 ] || echo s)"
}

# OPTION TEXT: a whole number above 0.
whole_number() {
  [[ $2 =~ ^[1-9][0-9]{0,6}$ ]] || refuse "$1: expected whole seconds, found '$2'"
  echo "$2"
}

# JSON KEY: its number.
number_in() {
  local value
  value=$(sed -n "s/.*\"$2\": *\\(-\\{0,1\\}[0-9][0-9]*\\).*/\\1/p" <<< "$1" | head -n 1)
  [ -n "$value" ] || refuse "eventide info: expected \"$2\", found none"
  echo "$value"
}

# FOLDER: whether a run in it came to its end, not stopped on the way.
is_finished() {
  [ -e "$1/run.json" ] && grep -Eq '"finished": *true' "$1/run.json" && ! grep -Eq '"complete": *false' "$1/run.json"
}

# OUT NUMBER: what the task begins with; the states of a recording have numbers of their own.
state_file() {
  local name
  name=$(sed -n "$(($2 + 1))p" "$1/plan.tsv" | cut -f 2)
  printf '%s/states/%s/state_%06d.safetensors' "$1" "$name" "$(head -n "$2" "$1/plan.tsv" | awk -F '\t' -v name="$name" '$2 == name && $6 != "-"' | wc -l)"
}

# SCRIPT OUT [NUMBER]: what a job of an array begins with. Sets `out`, `number`, and `options`, those of the run.
take_job() {
  expect_plan "$1" "${2:-}"
  out=${2%/}
  number=${3:-${SLURM_ARRAY_TASK_ID:-}}
  [[ $number =~ ^[0-9]{1,9}$ ]] || refuse "$1: expected a whole number or SLURM_ARRAY_TASK_ID, found '$number'"
  number=$((10#$number))
  options=()
  local option
  while IFS= read -r -d '' option; do options+=("$option"); done < "$out/options"
}

# SCRIPT OUT
expect_plan() {
  [ -n "$2" ] || refuse "$1: expected OUT, the folder of a plan"
  [ -e "$2/plan.tsv" ] || refuse "$1: $2: expected plan.tsv (submit.sh --plan makes it), found none"
}

part_name() {
  printf '%s.%06d' "$1" "$2"
}
