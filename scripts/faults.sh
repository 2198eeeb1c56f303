#!/usr/bin/env bash
# Faults, run for real and many times over: what the tests do at a few moments, at as many as asked for. Minutes to
# an hour; `scripts/faults.sh 50` kills a run at 50 of its writes and fills the disk at 50.
#   scripts/faults.sh [MOMENTS]      50 unless told otherwise; needs the preset dev built, with tests
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
expect_arguments 0 1 "$@"
cd "$(dirname "$0")/.."
export EVENTIDE_FAULT_MOMENTS=${1:-50}
expect_number faults MOMENTS "$EVENTIDE_FAULT_MOMENTS"
build=build/dev
expect_program faults "$build/tests/system/test_hard_cases" "preset dev builds it"

# A whole run: the disk full at a write, killed (SIGKILL) at a write.
"$build/tests/system/test_hard_cases" --gtest_filter='Faults.*'

# Each sink at a disk full at every byte; readers that go away; slow sinks and models; cameras in software, unplugged
# at every request of a session; sessions and what they leave open.
ctest --test-dir "$build" --output-on-failure \
  -R '^(FullDisk|Signals|ExitCodes|DavisUnplugged|Davis(Damage|Drops|Requests|Return|Transfers)|DvxplorerFaults|Live)\.|^Pipeline\..*(Slow|Error|Failed)'

# What a thousand times opened and closed leaves behind: cameras in software and what goes over networks, then recordings,
# files and networks.
for program in drivers/test_usb_cameras drivers/test_v4l2_camera drivers/test_v4l2_output drivers/test_udp simulate/test_simulate pipeline/sinks/http/test_http_sink ros2/test_ros2; do
  EVENTIDE_OPENINGS=1000 "$build/tests/$program" --gtest_brief=1 --gtest_filter='UsbOpenings.*:*LeavesNothingBehind'
done
"$build/apps/cli/eventide" stress --cases 'open-*'
