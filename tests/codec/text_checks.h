// A text recording, read as the program opens one.
#pragma once

#include "src/codec/text/text.h"

#include "tests/codec/parser_checks.h"

#include <memory>
#include <span>
#include <string>

namespace eventide {

inline constexpr int kTextWidth = 240, kTextHeight = 180;

/// Header and data of a text, the way a recording is opened.
inline Parsed parse_text(const std::string& text, const TextOptions& options = {},
                         int width = kTextWidth, int height = kTextHeight) {
    const Bytes bytes = to_bytes(text);
    const TextHeader header = read_text_header(bytes, options);
    return parse_whole(
        [&] { return std::make_unique<TextParser>(header.layout, width, height, options.reorder); },
        std::span(bytes).subspan(header.stream.data_offset));
}

}  // namespace eventide
