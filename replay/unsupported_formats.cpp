// Known by their first bytes.
#include "replay/unsupported_formats.h"

#include "src/codec/prophesee/evt_header.h"

#include <algorithm>
#include <array>

namespace eventide {

namespace {

using namespace std::string_view_literals;

struct Foreign {
    std::size_t offset;
    std::string_view magic, description;
};

constexpr std::array kForeign{
    Foreign{0, "\x1F\x8B"sv, "a gzip file; zcat FILE | eventide run - reads what is in it"},
    Foreign{0, "BZh"sv, "a bzip2 file; bzcat FILE | eventide run - reads what is in it"},
    Foreign{0,
            "\xFD"
            "7zXZ\0"sv,
            "an xz file; xzcat FILE | eventide run - reads what is in it"},
    Foreign{0, "\x28\xB5\x2F\xFD"sv,
            "a zstd file; zstdcat FILE | eventide run - reads what is in it"},
    Foreign{0, "#ROSBAG V1."sv,
            "a ROS bag of version 1; rosbag fix FILE NEW makes version 2 of it"},
    Foreign{0, "\x89PNG"sv, "an image"},
    Foreign{0, "\xFF\xD8\xFF"sv, "an image"},
    Foreign{4, "ftyp"sv, "a video"},
    Foreign{0, "\x1A\x45\xDF\xA3"sv, "a video"},
    Foreign{0, "RIFF"sv, "a video or sound"},
    Foreign{0, "YUV4MPEG2"sv, "a video"},
    Foreign{0,
            "\x7F"
            "ELF"sv,
            "a program"},
};

}  // namespace

std::string_view describe_foreign(std::span<const std::byte> first_bytes) {
    const std::string_view text(reinterpret_cast<const char*>(first_bytes.data()),
                                first_bytes.size());
    const auto found = std::find_if(kForeign.begin(), kForeign.end(), [&](const Foreign& each) {
        return text.substr(std::min(each.offset, text.size())).starts_with(each.magic);
    });
    return found == kForeign.end() ? std::string_view{} : found->description;
}

std::string describe_unread(std::span<const std::byte> first_bytes) {
    const std::string raw = evt_format_said(first_bytes);
    return raw.empty() ? "an unrecognised format" : "a Prophesee RAW file of format " + raw;
}

}  // namespace eventide
