// The packets of AEDAT4 and the XML that names the streams.
#include "src/codec/aedat4/aedat4_writer.h"

#include "src/codec/aedat4/aedat4_flat_writer.h"
#include "src/codec/aedat4/aedat4_header.h"
#include "src/codec/aedat4/aedat4_records.h"
#include "src/codec/append_text.h"
#include "src/codec/batch_parts.h"
#include "src/core/bayer.h"
#include "src/core/error.h"

#include <algorithm>
#include <string>

namespace eventide {

namespace {

std::string name_of(Aedat4Compression compression) {
    switch (compression) {
        case Aedat4Compression::none:
            return "NONE";
        case Aedat4Compression::lz4:
            return "LZ4";
        case Aedat4Compression::lz4_high:
            return "LZ4_HIGH";
        case Aedat4Compression::zstd:
            return "ZSTD";
        case Aedat4Compression::zstd_high:
            return "ZSTD_HIGH";
    }
    return {};
}

struct StreamText {
    std::string_view identifier, name, description;
    bool has_size;
};
constexpr StreamText kStreams[] = {
    {"EVTS", "events", "Array of events (polarity ON/OFF).", true},
    {"FRME", "frames", "Standard frame (8-bit image).", true},
    {"IMUS", "imu", "Inertial Measurement Unit data samples.", false},
    {"TRIG", "triggers", "External triggers and special signals.", false},
};

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (c == '<' || c == '>' || c == '&' || c == '"' || (c >= 0 && c < ' '))
            out += '?';
        else
            out += c;
    }
    return out;
}

std::string attr(std::string_view key, std::string_view type, const std::string& value) {
    return "<attr key=\"" + std::string(key) + "\" type=\"" + std::string(type) + "\">" + value +
           "</attr>\n";
}

/// As DV writes it: its reader takes the streams from the nodes under outInfo.
std::string info_node(const StreamHeader& header, Aedat4Compression compression) {
    const std::string base = "/mainloop/Recorder/outInfo/";
    std::string source = escaped(header.sensor_name.empty() ? "camera" : header.sensor_name);
    source += "_" + escaped(header.serial.empty() ? "0" : header.serial);
    std::string xml = "<dv version=\"2.0\">\n<node name=\"outInfo\" path=\"" + base + "\">\n";
    for (int id = 0; id < 4; ++id) {
        const StreamText& stream = kStreams[id];
        const std::string number = std::to_string(id), path = base + number + "/";
        xml.append("<node name=\"")
            .append(number)
            .append("\" path=\"")
            .append(path)
            .append("\">\n");
        xml += attr("compression", "string", name_of(compression));
        xml += attr("originalModuleName", "string", "capture");
        xml += attr("originalOutputName", "string", std::string(stream.name));
        xml += attr("typeDescription", "string", std::string(stream.description));
        xml += attr("typeIdentifier", "string", std::string(stream.identifier));
        xml += "<node name=\"info\" path=\"" + path + "info/\">\n";
        if (stream.has_size) {
            xml += attr("sizeX", "int", std::to_string(header.width));
            xml += attr("sizeY", "int", std::to_string(header.height));
            if (header.colour_filter != ColourFilter::none)
                xml += attr("colorFilter", "int", std::to_string(number_of(header.colour_filter)));
        }
        xml += attr("source", "string", source);
        xml += attr("tsOffset", "long", "0");  // times are as they are
        xml += "</node>\n</node>\n";
    }
    return xml + "</node>\n</dv>\n";
}

Error cannot_hold(const std::string& what) {
    return Error(ErrorKind::usage, "AEDAT4 cannot hold " + what);
}

std::int64_t time_of(SensorTime t) {
    if (!is_aedat4_time(to_us(t)))
        throw cannot_hold("the time " + std::to_string(to_us(t)) + " us");
    return to_us(t);
}

template <typename T>
Aedat4TableEntry entry_for(Aedat4Kind kind, std::span<const T> items) {
    Aedat4TableEntry entry;
    entry.stream = std::int32_t(kind);
    entry.elements = std::int64_t(items.size());
    entry.first = entry.last = items.front().t;
    for (const T& item : items) {
        entry.first = std::min(entry.first, item.t);
        entry.last = std::max(entry.last, item.t);
    }
    return entry;
}

template <typename T, typename Write>
void in_pieces(std::span<const T> rest, std::size_t most, const Write& write) {
    while (!rest.empty()) {
        const std::size_t n = std::min(most, rest.size());
        write(rest.first(n));
        rest = rest.subspan(n);
    }
}

}  // namespace

void Aedat4Writer::begin(const StreamHeader& header, std::vector<std::byte>& out) {
    append_text(out, kAedat4Magic);
    FlatWriter flat("IOHE", {4, 8, 4});
    flat.set(flat.root(), 0, std::int32_t(compression_));
    flat.set(flat.root(), 1, std::int64_t(-1));
    flat.set_text(flat.root(), 2, info_node(header, compression_));
    const auto bytes = flat.bytes();
    out.insert(out.end(), bytes.begin(), bytes.end());
    position_place_ = kAedat4Magic.size() + flat.root().fields[1];
    written_ = kAedat4Magic.size() + bytes.size();
}

void Aedat4Writer::packet(Aedat4TableEntry entry, FlatWriter& content,
                          std::vector<std::byte>& out) {
    const std::size_t begin = out.size();
    append_little(out, entry.stream);
    append_little(out, std::int32_t(0));
    pack_aedat4(content.bytes(), compression_, out);
    entry.bytes = std::int32_t(out.size() - begin - 8);
    for (std::size_t i = 0; i < 4; ++i)
        out[begin + 4 + i] = std::byte(std::uint32_t(entry.bytes) >> (8 * i) & 0xFF);
    entry.position = written_ + 8;
    written_ += out.size() - begin;
    table_.entries.push_back(entry);
}

void Aedat4Writer::write(const Batch& batch, std::vector<std::byte>& out) {
    in_parts(batch, [&](const BatchPart& part) {
        in_pieces(part.triggers, kPacketSamples, [&](auto piece) { write_triggers(piece, out); });
        in_pieces(part.events, kPacketEvents, [&](auto piece) { write_events(piece, out); });
        for (const ReferenceImage& image : part.images) write_image(image, out);
        in_pieces(part.imu, kPacketSamples, [&](auto piece) { write_imu(piece, out); });
    });
}

void Aedat4Writer::write_events(std::span<const Event> events, std::vector<std::byte>& out) {
    FlatWriter flat("EVTS", {4});
    std::size_t at =
        flat.begin_vector(flat.root(), 0, events.size(), kAedat4EventBytes, sizeof(std::int64_t));
    for (const Event& event : events) {
        if (event.x > 32767 || event.y > 32767)
            throw cannot_hold("an event at " + std::to_string(event.x) + ", " +
                              std::to_string(event.y) + "; the largest coordinate is 32767");
        flat.put(at, time_of(event.t));
        flat.put(at + 8, event.x);
        flat.put(at + 10, event.y);
        flat.put(at + 12, std::uint8_t(event.polarity));
        at += kAedat4EventBytes;
    }
    packet(entry_for(Aedat4Kind::events, events), flat, out);
}

void Aedat4Writer::write_image(const ReferenceImage& image, std::vector<std::byte>& out) {
    const auto values = image.pixels.values();
    const int channels = image.channels;
    const int width = channels > 0 ? image.pixels.width() / channels : 0;
    if (channels != 1 && channels != 3 && channels != 4)
        throw cannot_hold("an image of " + std::to_string(channels) + " channels");
    if (image.x0 < 0 || image.y0 < 0)
        throw cannot_hold("an image that begins at " + std::to_string(image.x0) + ", " +
                          std::to_string(image.y0) + ", beyond the sensor's edge");
    if (std::max({width, image.pixels.height(), image.x0, image.y0}) > 32767)
        throw cannot_hold("an image of more than 32767 px");
    const bool eight_bits =
        std::all_of(values.begin(), values.end(), [](std::uint16_t v) { return v % 257 == 0; });

    const std::int64_t begin = time_of(image.exposure_begin), end = time_of(image.exposure_end);
    const bool exposed = end > begin;
    FlatWriter flat("FRME", {8, 8, 8, 8, 8, 1, 2, 2, 2, 2, 4, 8});
    const FlatWriter::Table& root = flat.root();
    flat.set(root, 0, time_of(image.t));
    for (const int field : {1, 3}) flat.set(root, field, exposed ? begin : to_us(image.t));
    for (const int field : {2, 4}) flat.set(root, field, exposed ? end : to_us(image.t));
    flat.set(root, 5, std::int8_t((channels - 1) * 8 + (eight_bits ? 0 : 2)));
    flat.set(root, 6, std::int16_t(width));
    flat.set(root, 7, std::int16_t(image.pixels.height()));
    flat.set(root, 8, std::int16_t(image.x0));
    flat.set(root, 9, std::int16_t(image.y0));
    flat.set(root, 11, exposed ? end - begin : std::int64_t(0));
    const std::size_t bytes_each = eight_bits ? 1 : 2;
    std::size_t at = flat.begin_vector(root, 10, values.size() * bytes_each, 1, 4);
    for (const std::uint16_t value : values) {
        if (eight_bits)
            flat.put(at, std::uint8_t(value / 257));
        else
            flat.put(at, value);
        at += bytes_each;
    }
    packet(entry_for(Aedat4Kind::image, std::span(&image, 1)), flat, out);
}

void Aedat4Writer::write_imu(std::span<const ImuSample> samples, std::vector<std::byte>& out) {
    FlatWriter flat("IMUS", {4});
    const std::size_t list = flat.begin_vector(flat.root(), 0, samples.size(), 4, 4);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const ImuSample& sample = samples[i];
        const auto table = flat.begin_table({8, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4}, list + 4 * i);
        flat.set(table, 0, time_of(sample.t));
        flat.set(table, 1, sample.temperature_c);
        for (int axis = 0; axis < 3; ++axis) {
            flat.set(table, 2 + axis, sample.acceleration_g[std::size_t(axis)]);
            flat.set(table, 5 + axis, sample.gyro_dps[std::size_t(axis)]);
            flat.set(table, 8 + axis, sample.magnetic_ut[std::size_t(axis)]);
        }
    }
    packet(entry_for(Aedat4Kind::imu, samples), flat, out);
}

void Aedat4Writer::write_triggers(std::span<const Trigger> triggers, std::vector<std::byte>& out) {
    FlatWriter flat("TRIG", {4});
    const std::size_t list = flat.begin_vector(flat.root(), 0, triggers.size(), 4, 4);
    for (std::size_t i = 0; i < triggers.size(); ++i) {
        const int number = aedat4_trigger_number(triggers[i]);
        if (number < 0)
            throw cannot_hold("a trigger of kind " + std::to_string(int(triggers[i].kind)) +
                              " from source " + std::to_string(triggers[i].source));
        const auto table = flat.begin_table({8, 1}, list + 4 * i);
        flat.set(table, 0, time_of(triggers[i].t));
        flat.set(table, 1, std::uint8_t(number));
    }
    packet(entry_for(Aedat4Kind::triggers, triggers), flat, out);
}

void Aedat4Writer::finish(std::vector<std::byte>& out) {
    const std::vector<std::byte> table = aedat4_table_bytes(table_, compression_);
    out.insert(out.end(), table.begin(), table.end());
    Patch patch{position_place_, {}};
    append_little(patch.bytes, std::int64_t(written_));
    patches_ = {patch};
}

}  // namespace eventide
