// Where in a file a time lies.
#pragma once

#include "src/codec/parser.h"
#include "src/codec/stream.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

namespace eventide {

class ByteFile;

/// How a time is found in a file of one format. By default reading begins at the beginning.
struct SeekMeans {
    /// Set where a record tells its whole time: records start at a multiple of this many bytes, and
    /// a parser put there after resync() finds the next.
    std::uint64_t alignment = 0;
    /// Set where stamps wrap, so that a time is known only to who has seen the ones before: copies
    /// the parser that has.
    std::unique_ptr<Parser> (*copy)(const Parser&) = nullptr;
    /// Set where the file may hold an index: the position of a record before which no data at or
    /// after t lie; empty when there is no index or it does not fit the file.
    std::function<std::optional<std::uint64_t>(const ByteFile&, SensorTime t)> look_up{};
    /// How far before the newest time told up to a place data may lie that come behind it.
    SensorDuration slack{0};
};

using MakeParser = std::function<std::unique_ptr<Parser>(const StreamHeader&)>;

/// Where reading goes on, and in what state.
struct SeekPoint {
    std::uint64_t position = 0;
    /// The parser that has read all before; null where one that comes anew may take up.
    std::shared_ptr<const Parser> parser{};
};

/// A place before which no event at or after `t` lies. By the file's index, by bisection, or by
/// reading on from the beginning where stamps wrap. The beginning where the times found on the way
/// contradict each other.
SeekPoint find_seek_point(const ByteFile& file, const StreamHeader& header,
                          const MakeParser& make_parser, const SeekMeans& means, SensorTime t);

}  // namespace eventide
