#!/usr/bin/env bash
# Joins the parts of a plan: merge.sh OUT. OUT/NAME is then what one run of all would have written; parts stay, their images are the same files (hard
# links). Nothing is joined before every part is there, and what was joined before is left as it is.
set -euo pipefail
. "$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/common.sh"
expect_plan merge.sh "${1:-}"
out=${1%/}

missing=()
number=0
while IFS=$'\t' read -r _ name _; do
  is_finished "$out/parts/$(part_name "$name" $number)" || missing+=("$number")
  number=$((number + 1))
done < "$out/plan.tsv"
[ ${#missing[@]} -eq 0 ] || refuse "merge.sh: $out: not done yet: tasks ${missing[*]} (task.sh $out NUMBER does one)"

# PART TO: the lines of timestamps.csv before `to` become lines of the whole, with images under new numbers. Prints how many frames the whole has then,
# and the last number on its frame clock. In Perl, which links without a process for each image.
take_part() {
  perl -e '
    use strict; use warnings;
    my ($part, $work, $to, $count, $last) = @ARGV;
    my $base = $last + 1;
    sub opened { my ($how, $file) = @_; open(my $h, $how, $file) or die "merge.sh: $file: $!\n"; $h }
    my ($lines, $seconds) = (opened("<", "$part/timestamps.csv"), opened("<", "$part/timestamps.txt"));
    my ($table, $times) = (opened(">>", "$work/timestamps.csv"), opened(">>", "$work/timestamps.txt"));
    my @kinds = grep { -d "$part/$_->[0]" } ["frames", "frame", "png"], ["uncertainty", "unc", "tiff"], ["events", "events", "png"];
    <$lines>;
    while (my $line = <$lines>) {
      my ($frame, $index, $t, $rest) = split /,/, $line, 4;
      last if $to ne "-" && $t >= $to;
      for my $kind (@kinds) {
        my ($folder, $name, $end) = @$kind;
        my $from = sprintf "%s/%s/%s_%010d.%s", $part, $folder, $name, $frame, $end;
        link $from, sprintf("%s/%s/%s_%010d.%s", $work, $folder, $name, $count, $end) or die "merge.sh: $from: $!\n";
      }
      $last = $base + $index;
      print $table "$count,$last,$t,$rest";
      print $times scalar <$seconds>;
      ++$count;
    }
    close($table) && close($times) or die "merge.sh: $work: $!\n";
    print "$count $last\n";
  ' "$1" "$work" "$2" "$count" "$last_index"
}

cut -f 2 "$out/plan.tsv" | uniq | while read -r whole; do
  if is_finished "$out/$whole"; then
    echo "$out/$whole: done before" >&2
    continue
  fi
  work=$out/$whole.$$.work
  rm -rf "$out/$whole".[0-9]*.work
  mkdir -p "$work/frames"
  number=0 count=0 last_index=-1
  while IFS=$'\t' read -r _ name _ to _; do
    part=$out/parts/$(part_name "$name" $number)
    number=$((number + 1))
    [ "$name" = "$whole" ] || continue
    [ -e "$work/timestamps.csv" ] || head -n 1 "$part/timestamps.csv" > "$work/timestamps.csv"
    for kind in uncertainty events; do [ ! -d "$part/$kind" ] || mkdir -p "$work/$kind"; done
    joined=$(take_part "$part" "$to")
    read -r count last_index <<< "$joined"
  done < "$out/plan.tsv"
  quoted=${whole//\\/\\\\} # as JSON has it
  quoted=${quoted//\"/\\\"}
  printf '{\n  "program": "scripts/slurm/merge.sh",\n  "frames": %d,\n  "parts": "%s",\n  "finished": true\n}\n' "$count" "parts/$quoted.*" > "$work/run.json"
  [ ! -e "$out/$whole" ] || refuse "merge.sh: $out/$whole: something else is there; expected nothing"
  mv -T "$work" "$out/$whole"
  echo "$out/$whole: $(counted "$count" frame)" >&2
done
