// umockdev's preload library: under it a process sees devices that exist only for it and its
// children.
#pragma once

namespace eventide::testing_support {

/// True when the process runs under the preload library.
bool runs_in_testbed();

/// Starts the program again under the preload library; returns only when that is not possible. Call
/// it first in main().
void enter_testbed(char** argv);

}  // namespace eventide::testing_support
