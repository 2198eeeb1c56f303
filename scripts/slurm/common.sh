# What the scripts of this folder share.
EVENTIDE=${EVENTIDE:-eventide}

refuse() {
  echo "$1" >&2
  exit 2
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

# FOLDER: whether a run in it came to its end.
is_finished() {
  [ -e "$1/run.json" ] && grep -Eq '"finished": *true' "$1/run.json"
}

# OUT NUMBER: what the task begins with; the states of a recording have numbers of their own.
state_file() {
  local name
  name=$(sed -n "$(($2 + 1))p" "$1/plan.tsv" | cut -f 2)
  printf '%s/states/%s/state_%06d.safetensors' "$1" "$name" "$(head -n "$2" "$1/plan.tsv" | awk -F '\t' -v name="$name" '$2 == name && $6 != "-"' | wc -l)"
}

part_name() {
  printf '%s.%06d' "$1" "$2"
}
