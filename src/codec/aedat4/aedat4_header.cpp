// A flatbuffer with a text in XML inside.
#include "src/codec/aedat4/aedat4_header.h"

#include "src/codec/aedat4/aedat4_flat.h"
#include "src/core/bayer.h"
#include "src/core/byte_order.h"
#include "src/core/error.h"
#include "src/core/list_text.h"
#include "src/core/number_text.h"

#include <algorithm>
#include <cstring>

namespace eventide {

namespace {

/// The value of key="value" inside a tag.
std::string_view attribute(std::string_view tag, std::string_view key) {
    for (std::size_t at = tag.find(key); at != std::string_view::npos; at = tag.find(key, at + 1)) {
        const std::string_view rest = tag.substr(at + key.size());
        const bool whole_word = at > 0 && (tag[at - 1] == ' ' || tag[at - 1] == '\n');
        if (!whole_word || !rest.starts_with("=\"")) continue;
        const std::size_t end = rest.find('"', 2);
        return end == std::string_view::npos ? std::string_view{} : rest.substr(2, end - 2);
    }
    return {};
}

int number(std::string_view text) {
    const int value = number_in<int>(text).value_or(0);
    return value > 0 && value <= 32768 ? value : 0;
}

/// Walks through nodes and attributes; depth is bounded by the text itself.
class StreamsReader {
public:
    void node(std::string_view name) { path_.push_back(name); }
    void end_of_node() {
        if (!path_.empty()) path_.pop_back();
    }
    void attr(std::string_view key, std::string_view value) {
        const auto out = std::find(path_.begin(), path_.end(), "outInfo");
        const auto depth = path_.end() - out;
        if (depth < 2) return;
        const std::string_view name = out[1];
        const std::int32_t id = number_in<std::int32_t>(name).value_or(-1);
        if (id < 0) return;
        if (depth == 2 && key == "typeIdentifier") at(id).identifier = value;
        if (depth != 3 || out[2] != "info") return;
        if (key == "sizeX") at(id).width = number(value);
        if (key == "colorFilter") at(id).colour_filter = number(value);
        if (key == "sizeY") at(id).height = number(value);
        if (key == "source") at(id).source = value;
    }
    std::vector<Aedat4Stream> take() { return std::move(streams_); }

private:
    Aedat4Stream& at(std::int32_t id) {
        if (streams_.empty() || streams_.back().id != id) {
            const auto found = std::find_if(streams_.begin(), streams_.end(),
                                            [&](const Aedat4Stream& s) { return s.id == id; });
            if (found != streams_.end()) return *found;
            streams_.push_back({id, {}, 0, 0, {}, 0});
        }
        return streams_.back();
    }

    std::vector<std::string_view> path_;
    std::vector<Aedat4Stream> streams_;
};

std::string names_of_events(const std::vector<Aedat4Stream>& streams) {
    std::string names;
    for (const Aedat4Stream& stream : streams)
        if (stream.identifier == identifier_of(Aedat4Kind::events))
            add_to_list(names, std::to_string(stream.id) + " (" + stream.source + ")");
    return names.empty() ? "none" : names;
}

/// `wanted`: the event stream's number; empty: the first.
void choose_streams(Aedat4Header& header, std::string_view wanted) {
    const auto choose = [&](Aedat4Kind kind, auto&& is_wanted) {
        const auto found = std::ranges::find_if(header.streams, [&](const Aedat4Stream& stream) {
            return stream.identifier == identifier_of(kind) && is_wanted(stream);
        });
        if (found == header.streams.end()) return static_cast<const Aedat4Stream*>(nullptr);
        header.chosen[std::size_t(kind)] = found->id;
        return static_cast<const Aedat4Stream*>(&*found);
    };
    const Aedat4Stream* events = choose(Aedat4Kind::events, [&](const Aedat4Stream& stream) {
        return wanted.empty() || std::to_string(stream.id) == wanted;
    });
    if (!events && !wanted.empty())
        throw Error(ErrorKind::usage, "AEDAT4 header: expected an event stream " +
                                          std::string(wanted) + ", found " +
                                          names_of_events(header.streams));
    const auto of_camera = [&](const Aedat4Stream& stream) {
        return !events || stream.source == events->source;
    };
    const Aedat4Stream* images = choose(Aedat4Kind::image, of_camera);
    choose(Aedat4Kind::imu, of_camera);
    choose(Aedat4Kind::triggers, of_camera);
    const Aedat4Stream* camera = events ? events : images;
    if (!camera) return;
    if (images != nullptr)
        header.stream.colour_filter = colour_filter_of_number(std::uint32_t(images->colour_filter))
                                          .value_or(ColourFilter::none);
    header.stream.width = camera->width;
    header.stream.height = camera->height;
    header.stream.source_text = camera->source;
    const std::size_t split = camera->source.rfind('_');
    header.stream.sensor_name = camera->source.substr(0, split);
    if (split != std::string::npos) header.stream.serial = camera->source.substr(split + 1);
}

}  // namespace

std::vector<Aedat4Stream> read_aedat4_streams(std::string_view xml) {
    StreamsReader reader;
    while (!xml.empty()) {
        const std::size_t begin = xml.find('<'), end = xml.find('>', begin);
        if (begin == std::string_view::npos || end == std::string_view::npos) break;
        const std::string_view tag = xml.substr(begin + 1, end - begin - 1);
        xml.remove_prefix(end + 1);
        if (tag.starts_with("node ")) {
            if (!tag.ends_with('/')) reader.node(attribute(tag, "name"));
        } else if (tag.starts_with("/node")) {
            reader.end_of_node();
        } else if (tag.starts_with("attr ") && !tag.ends_with('/')) {
            reader.attr(attribute(tag, "key"), xml.substr(0, std::min(xml.find('<'), xml.size())));
        }
    }
    return reader.take();
}

Aedat4Header read_aedat4_header(std::span<const std::byte> first_bytes, std::string_view events) {
    const auto refuse = [](const std::string& what) {
        return Error(ErrorKind::input, "AEDAT4 header: " + what);
    };
    if (first_bytes.size() < kAedat4Magic.size() ||
        std::memcmp(first_bytes.data(), kAedat4Magic.data(), kAedat4Magic.size()) != 0)
        throw refuse("expected the first line \"#!AER-DAT4.0\", found something else");
    const auto buffer = first_bytes.subspan(kAedat4Magic.size());
    const std::size_t size = buffer.size() < 4 ? 0 : load_little<std::uint32_t>(buffer.data());
    if (buffer.size() < 4 || size > buffer.size() - 4)
        throw refuse("expected " + std::to_string(size) + " bytes, found " +
                     std::to_string(buffer.size() < 4 ? 0 : buffer.size() - 4));
    const auto root = read_flat_root(buffer);
    if (!root || root->identifier != "IOHE")
        throw refuse("expected a flatbuffer called IOHE, found something else");

    Aedat4Header header;
    header.stream.format = "aedat4";
    header.stream.data_offset = kAedat4Magic.size() + 4 + size;
    header.compression = Aedat4Compression(root->table.scalar<std::int32_t>(0));
    if (header.compression < Aedat4Compression::none ||
        header.compression > Aedat4Compression::zstd_high)
        throw refuse("expected compression 0 to 4, found " +
                     std::to_string(std::int32_t(header.compression)));
    header.table_position = root->table.scalar<std::int64_t>(1, -1);
    header.streams = read_aedat4_streams(root->table.text(2).value_or(""));
    choose_streams(header, events);
    return header;
}

}  // namespace eventide
