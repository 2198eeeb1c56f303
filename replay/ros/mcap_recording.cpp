// MCAP, as rosbag2 and tools that convert ROS 1 bags write it: records of u8 kind and u64 length,
// some of them packed in chunks (mcap.dev/spec).
#include "replay/ros/bag_recording.h"
#include "replay/ros/ros_reader.h"
#include "replay/stream/byte_file.h"
#include "src/codec/aedat4/aedat4_compression.h"
#include "src/io/bag_records.h"

#include <algorithm>
#include <array>
#include <map>

namespace eventide {

namespace {

constexpr std::uint64_t kMagicBytes = 8;
constexpr std::size_t kHeadBytes = 9;
constexpr std::uint64_t kLongest = std::uint64_t{1} << 28;  // bytes, of a record

enum Kind : std::uint8_t { footer = 2, schema = 3, channel = 4, message = 5, chunk = 6 };

class McapReader final : public RosReader {
public:
    McapReader(const std::string& path, const OpenOptions& options)
        : RosReader(path, options.stream), file_(path) {
        open("mcap", options);
    }

    double progress() const override {
        return double(at_) / double(std::max<std::uint64_t>(file_.size(), 1));
    }

protected:
    /// One record of the file.
    bool read_part(Damage& damage) override {
        std::array<std::byte, kHeadBytes> head;
        if (file_.read_at(at_, head) < head.size()) return cut_short(damage, at_ < file_.size());
        const auto kind = std::to_integer<std::uint8_t>(head[0]);
        const auto length = load_little<std::uint64_t>(head.data() + 1);
        if (kind == footer) return false;
        const std::uint64_t content = at_ + kHeadBytes, held = file_.size() - content;
        if (length > held) {
            if (kind == chunk && held <= kLongest)
                take_cut_chunk(content, std::size_t(held), damage);
            return cut_short(damage, true);
        }
        at_ = content + length;
        if (kind < schema || kind > chunk) return true;
        if (length > kLongest) {
            damage.count(DamageReason::bad_length);
            return true;
        }
        record_.resize(std::size_t(length));
        if (file_.read_at(content, record_) < record_.size()) return cut_short(damage, true);
        if (kind == chunk)
            take_chunk(damage);
        else
            take(kind, record_, damage);
        return true;
    }
    void rewind() override {
        at_ = kMagicBytes;
        types_of_schemas_.clear();
        readable_channels_.clear();
    }

private:
    static bool cut_short(Damage& damage, bool counts) {
        if (counts) damage.count(DamageReason::truncated);
        return false;
    }

    /// u64 begin, end, size, u32 check sum, packing, u64 length and records.
    void take_chunk(Damage& damage) {
        BlockReader reader{record_};
        reader.take(28);
        const std::string_view packing = text_of(reader.block());
        const auto length = reader.number<std::uint64_t>();
        const auto packed = reader.take(std::size_t(length));
        if (!reader.good()) return damage.count(DamageReason::bad_length);
        const bool bare = packing.empty() || packing == "none";
        const auto bytes = bare ? std::optional(packed) : unpacker_.unpack(packed);
        if (!bytes || (!bare && packing != "lz4" && packing != "zstd"))
            return damage.count(DamageReason::bad_compression);
        if (!take_records(*bytes, damage)) damage.count(DamageReason::bad_length);
    }

    /// Where its records are not packed, those before the end are whole.
    void take_cut_chunk(std::uint64_t content, std::size_t held, Damage& damage) {
        record_.resize(held);
        if (file_.read_at(content, record_) < held) return;
        BlockReader reader{record_};
        reader.take(28);
        const std::string_view packing = text_of(reader.block());
        reader.number<std::uint64_t>();
        if (!reader.good() || (!packing.empty() && packing != "none")) return;
        take_records(std::span(record_).subspan(28 + 4 + packing.size() + 8), damage);
    }

    /// False where the last is cut short.
    bool take_records(std::span<const std::byte> bytes, Damage& damage) {
        for (BlockReader records{bytes};;) {
            const auto kind = records.number<std::uint8_t>();
            if (!records.good()) return true;
            const auto content = records.take(std::size_t(records.number<std::uint64_t>()));
            if (!records.good()) return false;
            take(kind, content, damage);
        }
    }

    void take(std::uint8_t kind, std::span<const std::byte> content, Damage& damage) {
        BlockReader reader{content};
        const auto number = reader.number<std::uint16_t>();
        if (kind == schema) {
            const std::string_view name = text_of(reader.block());
            if (reader.good()) types_of_schemas_[number] = name;
        } else if (kind == channel) {
            const auto type = types_of_schemas_.find(reader.number<std::uint16_t>());
            const std::string_view name = text_of(reader.block());
            const std::string_view wire = text_of(reader.block());
            if (!reader.good()) return damage.count(DamageReason::bad_record);
            const bool readable =
                type != types_of_schemas_.end() && (wire == "cdr" || wire == "ros1");
            readable_channels_[number] = readable;
            if (readable)
                add_topic(number, name, type->second,
                          wire == "ros1" ? RosWire::ros1 : RosWire::cdr);
        } else if (kind == message) {
            reader.take(20);  // sequence number, times of writing and sending
            // Of a channel that only comes later nobody knows what it holds, also at a second
            // reading.
            const auto channel = readable_channels_.find(number);
            if (!reader.good() || channel == readable_channels_.end())
                return damage.count(DamageReason::bad_record);
            if (channel->second) add_message(number, content.subspan(22));
        } else {
            return;
        }
        if (!reader.good()) damage.count(DamageReason::bad_record);
    }

    ByteFile file_;
    std::uint64_t at_ = kMagicBytes;
    std::vector<std::byte> record_;
    Aedat4Unpacker unpacker_;
    std::map<std::uint16_t, std::string> types_of_schemas_;
    std::map<std::uint16_t, bool>
        readable_channels_;  ///< of those told so far: in CDR or ROS 1's way
};

}  // namespace

std::unique_ptr<DataReader> open_mcap(const std::string& path, const OpenOptions& options) {
    return std::make_unique<McapReader>(path, options);
}

}  // namespace eventide
