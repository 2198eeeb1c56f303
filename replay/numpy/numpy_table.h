// Events in the rows of NumPy's arrays.
#pragma once

#include "replay/event_table.h"
#include "src/codec/text/text_layout.h"
#include "src/io/byte_source.h"
#include "src/io/numpy_array.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace eventide {

/// Rows of a fixed number of bytes somewhere in a source, the newest block of them at hand.
struct NumpyRows {
    std::shared_ptr<ByteSource> source;
    std::uint64_t begin = 0, stride = 0;
    std::vector<std::byte> block{};

    bool read(std::uint64_t first, std::size_t count) {
        block.resize(std::size_t(stride) * count);
        return source->read_at(begin + first * stride, block);
    }
};

struct NumpyColumn {
    std::size_t rows = 0;  ///< which of the rows
    NumpyField field;
    std::string name;
};

/// What is known of a file's events before the unit of time is.
struct NumpyEvents {
    std::vector<NumpyRows> rows;
    std::vector<NumpyColumn> columns;  ///< four, in the order of the file
    std::uint64_t count = 0;
    bool named = true;
    bool is_cut = false;  ///< there were to be more
};

/// `layout`: which column is what, and the unit of time.
std::unique_ptr<EventTable> make_numpy_table(NumpyEvents events, const TextLayout& layout);

}  // namespace eventide
