#!/usr/bin/env bash
# Builds the library of events to frames for 64-bit ARM, runs it in emulation, and compares its frames with this machine's. Needs
# g++-aarch64-linux-gnu and qemu-user-static; Debian's libraries for ARM come into build/arm, the system's packages stay as they are.
#   scripts/check-arm.sh
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
expect_arguments 0 0 "$@"
cd "$(dirname "$0")/.."
for program in aarch64-linux-gnu-g++ qemu-aarch64-static; do
  command -v "$program" >/dev/null || { echo "check-arm: expected $program (packages g++-aarch64-linux-gnu, qemu-user-static), found none" >&2; exit 1; }
done

arm=$PWD/build/arm
root=$arm/root
mkdir -p "$arm"/apt/lists/partial "$arm"/apt/archives/partial "$root"
: >"$arm/apt/status"
for_arm=(apt-get -q -o "Dir::State=$arm/apt" -o "Dir::State::status=$arm/apt/status" -o "Dir::Cache=$arm/apt" -o APT::Architecture=arm64 -o APT::Architectures=arm64)
"${for_arm[@]}" update
"${for_arm[@]}" install -y --no-install-recommends --download-only libhwy-dev libtbb-dev nlohmann-json3-dev
for package in "$arm"/apt/archives/*.deb; do dpkg -x "$package" "$root"; done

cat >"$arm/toolchain.cmake" <<END
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH $root)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_LIBDIR} $root/usr/lib/aarch64-linux-gnu/pkgconfig:$root/usr/share/pkgconfig)
set(ENV{PKG_CONFIG_SYSROOT_DIR} $root)
END
core=(-G Ninja -DCMAKE_BUILD_TYPE=Release -DEVENTIDE_TESTS=OFF -DEVENTIDE_IO=OFF -DEVENTIDE_ONEDNN=OFF -DBUILD_SHARED_LIBS=ON)
cmake -S . -B "$arm/build" -DCMAKE_TOOLCHAIN_FILE="$arm/toolchain.cmake" "${core[@]}"
cmake --build "$arm/build"
cmake -S . -B "$arm/here" "${core[@]}"
cmake --build "$arm/here"

# 0.1 s of a bar that moves.
/usr/bin/python3 - >"$arm/events.txt" <<'END'
print("48 36")
for i in range(4000):
    x = (i // 100 + i % 3) % 48
    print(f"{i * 25e-6:.6f} {x} {i * 7 % 36} {i % 3 != 2:d}")
END
libraries=$root/usr/lib/aarch64-linux-gnu
aarch64-linux-gnu-g++ -std=c++20 -O2 -Iinclude examples/from_text.cpp -o "$arm/from_text" -L"$arm/build/library" -leventide-core -Wl,-rpath-link,"$libraries"
EVENTIDE_MODELS=$PWD/config/models qemu-aarch64-static -L /usr/aarch64-linux-gnu -E LD_LIBRARY_PATH="$arm/build/library:$libraries" "$arm/from_text" "$arm/events.txt" "$arm/frames.arm"
g++ -std=c++20 -O2 -Iinclude examples/from_text.cpp -o "$arm/from_text_here" -L"$arm/here/library" -leventide-core -Wl,-rpath,"$arm/here/library"
EVENTIDE_MODELS=$PWD/config/models "$arm/from_text_here" "$arm/events.txt" "$arm/frames.here"
/usr/bin/python3 - "$arm/frames.arm" "$arm/frames.here" <<'END'
import sys

import numpy as np

arm, here = (np.fromfile(file, np.float32) for file in sys.argv[1:])
assert arm.size == here.size > 0, f"check-arm: expected {here.size} numbers, found {arm.size}"
error = np.abs(arm - here).max()
assert error < 1e-5, f"check-arm: expected frames within 1e-5, found {error}"
print(f"check-arm: {arm.size} numbers of frames and sigma, within {error:.1g}")
END
