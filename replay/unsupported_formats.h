// Files that are no recordings eventide reads, but that users try.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace eventide {

/// What a file that begins with these bytes is, with what to do where there is something; empty
/// when it is nothing known here.
std::string_view describe_foreign(std::span<const std::byte> first_bytes);

/// As above, of a file that is none of the formats read.
std::string describe_unread(std::span<const std::byte> first_bytes);

}  // namespace eventide
