// How a text recording is written: which column is what, and the unit of time.
#pragma once

#include "src/codec/stream.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace eventide {

enum class TextTimeUnit : std::uint8_t {
    automatic,
    seconds,
    milliseconds,
    microseconds,
    nanoseconds
};

/// What the user states. Throws nothing by itself: read_text_header() checks it.
struct TextOptions {
    std::string columns{};  ///< a permutation of "txyp"; empty: from a header row, else "txyp"
    /// Automatic: seconds when any time near the beginning has a decimal point or an exponent, else
    /// microseconds, or what makes more sense of the rate of events there.
    TextTimeUnit unit = TextTimeUnit::automatic;
    /// Rows that come at most so much before one already read are put in order (reorder.h).
    SensorDuration reorder = kUsualReorder;
    static constexpr SensorDuration kUsualReorder{10'000};
};

enum class TextField : std::uint8_t { time, x, y, polarity, ignored };

struct TextLayout {
    static constexpr std::size_t kMaxColumns = 16;

    std::array<TextField, kMaxColumns> columns{TextField::time, TextField::x, TextField::y,
                                               TextField::polarity};
    std::size_t n_columns = 4;                  ///< further ones on a line are ignored
    TextTimeUnit unit = TextTimeUnit::seconds;  ///< never automatic
    int off = 0, on = 1;  ///< polarities, not negative; with 0 and 1, -1 is off, too
};

struct TextHeader {
    StreamHeader stream;  ///< width and height from a first line or a comment, else 0
    TextLayout layout;
    std::vector<std::string> remarks{};  ///< on what was guessed with little to go by
};

/// True when the bytes look like a text recording: printable, and the first lines are comments, a
/// header row, a "width height" line, or rows of at least four numbers. Comments alone are no
/// recording, unless one says the size.
bool looks_like_text(std::span<const std::byte> first_bytes);

/// Throws Error (input) when the bytes hold neither a line of data nor one that says the size or
/// the columns, or the lines are no rows of events; Error (usage) when the options contradict
/// themselves.
TextHeader read_text_header(std::span<const std::byte> first_bytes, const TextOptions& options);

}  // namespace eventide
