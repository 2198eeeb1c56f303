// A source that is a file: it can say how long it is and jump.
#pragma once

#include "pipeline/source.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace eventide {

class Recording : public Source {
public:
    bool is_live() const noexcept override { return false; }

    /// Goes to a byte from which every event at or after `t` will be read (earlier ones may come
    /// too). Source thread, between reads; what is read then is for a parser made then. Standard
    /// input cannot go back: there it does nothing.
    virtual void seek(SensorTime t) = 0;

    /// Bytes of the whole recording, for progress; 0 where not known (standard input).
    virtual std::uint64_t size_bytes() const = 0;
    virtual std::uint64_t position_bytes() const = 0;

    /// What had to be guessed, or was not found, when it was opened: sentences for people.
    virtual std::vector<std::string> remarks() const { return {}; }

    /// A parser whose clock() is that of make_parser(), without costly extras (images read from
    /// files): for whoever needs the time of bytes and not the data.
    virtual std::unique_ptr<Parser> make_clock() const { return make_parser(); }
};

}  // namespace eventide
