#!/usr/bin/env bash
# ROS 2 topics between two hosts that are two network namespaces with a cable (veth) between them: discovery by multicast, and every image on the
# other side, in Cyclone DDS and Fast DDS. two_namespaces.sh EVENTIDE LISTENER [FASTDDS_PEER]; 77: not permitted here.
# Namespaces and cable end with the processes in them.
set -euo pipefail
if [ "${1:-}" != --inside ]; then
  unshare=(unshare --net)
  [ "$(id -u)" -eq 0 ] || unshare=(unshare --user --map-root-user --net)
  command -v ip > /dev/null || { echo "skipped: no ip (iproute2)"; exit 77; }
  "${unshare[@]}" ip link add probe type veth peer name eborp 2> /dev/null ||
    { echo "skipped: network namespaces or veth pairs are not permitted here (${unshare[*]})"; exit 77; }
  exec "${unshare[@]}" "$0" --inside "$@"
fi
shift
eventide=$1 listener=$2 peer=${3:-}
for program in "$eventide" "$listener" ${peer:+"$peer"}; do
  [ -x "$program" ] || { echo "expected the program $program, found none: it has to be built" >&2; exit 1; }
done

work=$(mktemp -d)
pids=()
cleanup() {
  kill "${pids[@]}" 2> /dev/null || true
  rm -rf "$work"
}
trap cleanup EXIT
# WHAT COMMAND...: until it holds, half a minute at most.
wait_until() {
  local what=$1 i
  shift
  for ((i = 0; i < 300; ++i)); do
    "$@" && return 0
    sleep 0.1
  done
  echo "expected $what within 30 s" >&2
  return 1
}

# The other host: a process that holds its namespace.
unshare --net sleep 600 > /dev/null &
other=$!
pids+=("$other")
elsewhere() { nsenter --target "$other" --net "$@"; }
is_apart() { [ "$(readlink "/proc/$other/ns/net")" != "$(readlink /proc/self/ns/net)" ]; }
wait_until "a second namespace" is_apart
ip link add here type veth peer name there
ip link set there netns "$other"
# DDS wants a loopback beside the cable, as every host has one.
ip link set lo up && ip address add 10.77.0.1/24 dev here && ip link set here up && ip route add 224.0.0.0/4 dev here
elsewhere sh -c 'ip link set lo up && ip address add 10.77.0.2/24 dev there && ip link set there up && ip route add 224.0.0.0/4 dev there'
are_up() { ip link show here up | grep -q 'state UP' && elsewhere ip link show there up | grep -q 'state UP'; }
wait_until "a cable that is up" are_up

# No settings of the user's or of the other tests': what DDS does by itself.
unset CYCLONEDDS_URI ROS_LOCALHOST_ONLY ROS_AUTOMATIC_DISCOVERY_RANGE ROS_STATIC_PEERS
export ROS_DOMAIN_ID=42 TEST_DOMAIN_OF=namespaces FASTDDS_PEER_ON_NETWORK=1
"$eventide" simulate --seconds 0.4 --size 64x48 --out "$work/recording.aedat4" --quiet
subscribers=1
nsenter --target "$other" --net "$listener" /two/image_raw image reliable > "$work/cyclone" &
pids+=($!)
if [ -n "$peer" ]; then
  subscribers=2
  nsenter --target "$other" --net "$peer" listen /two/image_raw reliable > "$work/fastdds" &
  pids+=($!)
fi
# Of /proc/net/dev, as /sys shows the first host's.
received() { elsewhere sed -n 's/^ *there: *\([0-9]*\) .*/\1/p' /proc/net/dev; }
before=$(received)
timeout 120 "$eventide" run "$work/recording.aedat4" --fps 100 --out "ros2:/two?subscribers=$subscribers" --out "gray8:$work/frames" --quiet

frames=$(($(stat -c %s "$work/frames") / (64 * 48)))
[ "$frames" -ge 30 ] || { echo "expected 30 frames at least, found $frames" >&2; exit 1; }
# A line when they are ready, and one per image.
for who in cyclone ${peer:+fastdds}; do
  has_all() { [ "$(wc -l < "$work/$who")" -eq $((frames + 1)) ]; }
  wait_until "$frames images in $who" has_all || { echo "found $(($(wc -l < "$work/$who") - 1))" >&2; exit 1; }
done
[ -z "$peer" ] || cmp <(tail -n +2 "$work/cyclone") <(tail -n +2 "$work/fastdds")
[ "$(tail -n +2 "$work/cyclone" | cut -d ' ' -f 2 | sort -u | wc -l)" -gt 1 ] || { echo "expected images that differ" >&2; exit 1; }
crossed=$(($(received) - before))
[ "$crossed" -ge $((frames * 64 * 48)) ] || { echo "expected $((frames * 64 * 48)) bytes on the cable, found $crossed" >&2; exit 1; }
echo "$frames images in $subscribers subscribers on the other side, $crossed bytes on the cable"
