// Flags that would change nothing.
#pragma once

#include "apps/cli/command.h"
#include "src/core/error.h"
#include "src/model/engine.h"

#include <algorithm>
#include <string>

namespace eventide::app {

/// For a flag that changes nothing without something else, which is not there: a misunderstanding.
/// What a configuration file or the environment says is no flag, as it is for other calls, too.
/// Throws Error (usage) where `key` is among the flags.
inline void refuse_idle_flag(const FlagKeys& flags, const std::string& key,
                             const std::string& expected, const std::string& found = "none") {
    if (!flags.contains(key)) return;
    std::string flag = "--" + key;
    std::ranges::replace(flag, '_', '-');
    throw Error(ErrorKind::usage, flag + ": expected " + expected + ", found " + found);
}

/// The plain engine has float32 alone.
inline void refuse_idle_precision(const FlagKeys& flags, Engine engine, Precision precision) {
    if (engine == Engine::plain && precision == Precision::bf16)
        refuse_idle_flag(flags, "precision", "f32 with --engine plain", "bf16");
}

}  // namespace eventide::app
