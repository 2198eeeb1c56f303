// From a path to a Recording: reads the first bytes, asks the table, completes the geometry.
#include "replay/data_recording.h"
#include "replay/ecd_folder.h"
#include "replay/formats.h"
#include "replay/image_file.h"
#include "replay/stream/aedat4_streams.h"
#include "replay/stream/scan_geometry.h"
#include "replay/unsupported_formats.h"
#include "src/codec/text/text_row.h"
#include "src/core/error.h"
#include "src/core/list_text.h"
#include "src/core/sensor_limits.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <utility>

namespace eventide {

namespace {

// A text stream is known from a few rows, behind the lines of its size and its columns; waiting for
// more would hold up whoever types them.
constexpr int kLinesOfStreamToSee = 4;

bool has_seen_rows(std::span<const std::byte> text) {
    std::string_view rest(reinterpret_cast<const char*>(text.data()), text.size());
    int lines = 0;
    for (std::size_t end = rest.find('\n'); end != rest.npos; end = rest.find('\n')) {
        lines += is_comment(rest.substr(0, end)) ? 0 : 1;
        rest.remove_prefix(end + 1);
    }
    return lines >= kLinesOfStreamToSee;
}

/// Whether more bytes could say nothing else of the recording than these do. Of a header that is
/// not whole they could; the next of its lines would begin as the one before.
bool has_seen_enough(const Format& format, std::span<const std::byte> read,
                     const OpenOptions& options) {
    if (format.name == "text") return has_seen_rows(read);
    if (format.open == nullptr) return true;  // no stream: it is refused
    try {
        const std::size_t header = format.open(read, options).header.data_offset;
        if (read.size() < header + format.looks_at) return false;
        const bool has_lines = read[0] == std::byte('#') || read[0] == std::byte('%');
        return !has_lines || read[header] != read[0];
    } catch (const Error&) {
        return false;
    }
}

/// Most formats hold the events of one camera.
void check_stream(const ByteFile& file, const Format& format, const OpenOptions& options) {
    if (options.stream.empty() || format.holds.streams) return;
    std::string names;
    for (const Format& each : all_formats())
        if (each.holds.streams) add_to_list(names, each.name);
    throw Error(ErrorKind::usage, file.path() + ": expected a format with several event streams (" +
                                      names + ") for the stream '" + options.stream + "', found " +
                                      std::string(format.title));
}

/// The beginning of the file. Of a pipe only as much as it takes to know what it is: a camera's
/// may fill slowly.
std::vector<std::byte> read_head(ByteFile& file, const OpenOptions& options) {
    std::vector<std::byte> head;
    if (file.is_seekable()) {
        head.resize(std::size_t(std::min<std::uint64_t>(kHeadBytes, file.size())));
        head.resize(file.read_at(0, head));
        return head;
    }
    head.resize(kHeadBytes);
    std::size_t size = 0;
    while (size < head.size()) {
        const std::size_t n = file.read_some(std::span(head).subspan(size), options.give_up);
        if (n == 0) break;
        size += n;
        const auto read = std::span(head).first(size);
        const Format* format =
            options.format.empty() ? detect_format(read) : find_format(options.format);
        if (format && has_seen_enough(*format, read, options)) break;
    }
    head.resize(size);
    return head;
}

const Format& choose_format(const ByteFile& file, std::span<const std::byte> head,
                            const OpenOptions& options) {
    if (head.empty())
        throw Error(ErrorKind::input, file.path() + ": expected a recording, the file is empty");
    // Before the formats themselves: a ROS bag looks like an AEDAT 1 file.
    const std::string_view foreign = describe_foreign(head);
    const Format* format = !options.format.empty() ? find_format(options.format)
                           : foreign.empty()       ? detect_format(head)
                                                   : nullptr;
    if (format) check_stream(file, *format, options);
    if (format) return *format;
    const std::string names = list_of(all_formats(), &Format::name);
    if (!options.format.empty())
        throw Error(ErrorKind::usage,
                    "format: expected one of " + names + ", found \"" + options.format + "\"");
    throw Error(ErrorKind::input,
                file.path() + ": expected a recording (" + names + "), found " +
                    (foreign.empty() ? describe_unread(head) : std::string(foreign)));
}

OpenedStream open_stream(const ByteFile& file, const Format& format,
                         std::span<const std::byte> head, const OpenOptions& options) {
    if (format.open == nullptr)
        throw Error(ErrorKind::input, file.path() + ": expected a stream of bytes, found " +
                                          std::string(format.title));
    try {
        return format.open(head, options);
    } catch (const Error& error) {
        throw Error(error.kind(), file.path() + ": " + error.what());
    }
}

void check_size(const OpenOptions& options) {
    if ((options.width > 0) != (options.height > 0) || options.width < 0 ||
        options.width > kLargestRecordedSide || options.height > kLargestRecordedSide)
        throw Error(ErrorKind::usage, "geometry: expected WIDTHxHEIGHT, each 1 to 65536, found " +
                                          std::to_string(options.width) + "x" +
                                          std::to_string(options.height));
}

/// `of_images`: of the images beside the events, which decides where nothing states the sensor's.
void complete_geometry(const ByteFile& file, OpenedStream& stream, const OpenOptions& options,
                       ImageSize of_images) {
    StreamHeader& header = stream.header;
    check_size(options);
    if (options.width > 0) {
        header.width = options.width;
        header.height = options.height;
    }
    if (header.width > 0 && header.height > 0) return;
    header.width = of_images.width;
    header.height = of_images.height;
    if (header.width > 0 && header.height > 0) return;
    if (!file.is_seekable())
        throw Error(
            ErrorKind::input,
            file.path() + ": expected the size of the sensor, found none in the stream; " +
                (header.format == "text" ? "begin the text with a line \"WIDTH HEIGHT\", or "
                                         : "") +
                kStateSize);
    scan_geometry(file, stream);
}

std::unique_ptr<Recording> open_by_path(const ByteFile& file, const Format& format,
                                        const OpenOptions& options) {
    if (!file.is_seekable())
        throw Error(ErrorKind::input, file.path() +
                                          ": expected a file that can be read in any "
                                          "order, as " +
                                          std::string(format.title) + " needs, found a pipe");
    check_size(options);
    return std::make_unique<DataRecording>(format.open_path(file.path(), options), file.size());
}

std::unique_ptr<FileRecording> open_as_stream(ByteFile file, std::vector<std::byte> head,
                                              const Format& format, const OpenOptions& options,
                                              ImageSize of_images = {}) {
    OpenedStream stream = open_stream(file, format, head, options);
    if (file.is_seekable() && stream.header.format == "aedat4") {
        const Aedat4Header header = read_aedat4_header(head);
        std::ranges::move(compare_aedat4_streams(file, header), std::back_inserter(stream.remarks));
        if (auto joined = find_joined_aedat4(file, header))
            stream.remarks.push_back(std::move(*joined));
    }
    complete_geometry(file, stream, options, of_images);
    const std::size_t header_bytes = std::min<std::size_t>(stream.header.data_offset, head.size());
    head.erase(head.begin(), head.begin() + std::ptrdiff_t(header_bytes));
    if (file.is_seekable()) head.clear();
    return std::make_unique<FileRecording>(std::move(file), std::move(stream), std::move(head));
}

std::unique_ptr<Recording> open_file(const std::string& path, const OpenOptions& options) {
    ByteFile file(path, options.while_waiting);
    std::vector<std::byte> head = read_head(file, options);
    const Format& format = choose_format(file, head, options);
    if (format.open_path != nullptr) return open_by_path(file, format, options);
    return open_as_stream(std::move(file), std::move(head), format, options);
}

std::unique_ptr<FileRecording> open_events_of(const std::string& folder, const OpenOptions& options,
                                              ImageSize of_images) {
    ByteFile file((std::filesystem::path(folder) / "events.txt").string(), options.while_waiting);
    std::vector<std::byte> head = read_head(file, options);
    const Format& format = choose_format(file, head, options);
    return open_as_stream(std::move(file), std::move(head), format, options, of_images);
}

}  // namespace

std::unique_ptr<Recording> open_recording(const std::string& path, const OpenOptions& options) {
    if (const auto folder = find_ecd_folder(path)) {
        EcdImages images = read_ecd_images(*folder);
        auto events = open_events_of(*folder, options, {images.width, images.height});
        return std::make_unique<EcdRecording>(std::move(events), std::move(images));
    }
    return open_file(path, options);
}

}  // namespace eventide
