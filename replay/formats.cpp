// The table of formats. To add one: a parser in src/codec, and a row here.
#include "replay/formats.h"

#include "src/codec/text.h"
#include "src/core/error.h"

#include <algorithm>
#include <array>

namespace eventide {

namespace {

using Bytes = std::span<const std::byte>;

template <typename Writer>
std::unique_ptr<StreamWriter> make() {
    return std::make_unique<Writer>();
}

OpenedStream open_text(Bytes first_bytes, const OpenOptions& options) {
    const TextHeader header = read_text_header(first_bytes, options.text);
    const auto make_parser = [layout = header.layout](const StreamHeader& stream) {
        return std::make_unique<TextParser>(layout, stream.width, stream.height);
    };
    return {header.stream, make_parser, 1, true};
}

constexpr FormatHolds kOnlyEvents{};
constexpr FormatHolds kEverything{true, true, true, true};

// Formats that say what they are come first, text last.
const std::array kFormats{
    Format{"text", "lines of \"t x y p\"", ".txt", kOnlyEvents, looks_like_text, open_text,
           make<TextWriter>},
};

}  // namespace

std::span<const Format> all_formats() {
    return kFormats;
}

const Format* find_format(std::string_view name) {
    const auto found = std::find_if(kFormats.begin(), kFormats.end(),
                                    [&](const Format& format) { return format.name == name; });
    return found == kFormats.end() ? nullptr : &*found;
}

const Format* detect_format(Bytes first_bytes) {
    const auto found = std::find_if(kFormats.begin(), kFormats.end(), [&](const Format& format) {
        return format.matches(first_bytes);
    });
    return found == kFormats.end() ? nullptr : &*found;
}

const Format* format_for_writing(const std::string& path) {
    const auto found = std::find_if(kFormats.begin(), kFormats.end(), [&](const Format& format) {
        return format.make_writer && path.ends_with(format.extension);
    });
    return found == kFormats.end() ? nullptr : &*found;
}

std::unique_ptr<StreamWriter> open_writer(std::string_view name) {
    const Format* format = find_format(name);
    if (!format || !format->make_writer) {
        std::string writable;
        for (const Format& each : kFormats)
            if (each.make_writer)
                writable += (writable.empty() ? "" : ", ") + std::string(each.name);
        throw Error(ErrorKind::usage, "format to write: expected one of " + writable +
                                          ", found \"" + std::string(name) + "\"");
    }
    return format->make_writer();
}

}  // namespace eventide
