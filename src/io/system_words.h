// What the operating system said, in words.
#pragma once

#include <string>
#include <system_error>

namespace eventide {

/// What to say of an errno value: the system's own words, and what to do where those do not help.
std::string system_words(int error);
/// The same of what the standard library throws: a thread that cannot be started says little by
/// itself.
std::string system_words(const std::system_error& error);

/// Whether this process cannot open so many files more: for libraries that do not say why they
/// failed.
bool out_of_descriptors(int needed);

}  // namespace eventide
