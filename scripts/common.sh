# What the scripts of this folder share; they source it first. Asked for --help, a script shows its own head and ends.
# shellcheck shell=bash
export LC_ALL=C # decimal points

usage() { sed -n '2,/^[^#]/s/^# \{0,1\}//p' "$0"; }

case "${1:-}" in -h | --help)
  usage
  exit
  ;;
esac

# Paths are of the folder one is in, though most scripts go on in the project's.
for variable in EVENTIDE TRAIN PACK; do
  [[ ${!variable:-} != */* ]] || printf -v "$variable" %s "$(realpath -ms "${!variable}")"
done
for variable in OUT PACKS EVENTIDE_MODELS; do
  [ -z "${!variable:-}" ] || printf -v "$variable" %s "$(realpath -ms "${!variable}")"
done

# MESSAGE
refuse() {
  echo "$1" >&2
  exit 2
}

# LEAST MOST ARGUMENT...: shows how the script is called where there are fewer or more arguments.
expect_arguments() {
  local least=$1 most=$2
  shift 2
  [ $# -ge "$least" ] && [ $# -le "$most" ] && return
  usage >&2
  exit 2
}

# SCRIPT FILE...
expect_files() {
  local file
  for file in "${@:2}"; do [ -e "$file" ] || refuse "$1: expected $file, found none"; done
}

# SCRIPT PROGRAM HOW: of a path or in PATH; HOW it comes to be there.
expect_program() {
  command -v "$2" > /dev/null || refuse "$1: expected the program $2 ($3), found none"
}

# SCRIPT NAME TEXT: a whole number above 0.
expect_number() {
  [[ $3 =~ ^[1-9][0-9]{0,8}$ ]] || refuse "$1: $2: expected a whole number above 0, found '$3'"
}
