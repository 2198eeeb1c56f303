// Which program this is, and what it was built with.
#pragma once

#include <string>

namespace eventide::app {

/// "0.1.0"
std::string version();

/// For --version: version, compiler, flags and the libraries that matter, a line each.
std::string version_text();

/// "g++ 12.2.0, -O3 -DNDEBUG"
std::string compiler_text();

/// The processor's own name and the instruction sets that matter here.
std::string processor_text();

}  // namespace eventide::app
