// ROS 1 bags: chunks of messages, which tell where a time lies.
#include "replay/ros/bag_recording.h"

#include "replay/ros/ros_reader.h"
#include "src/io/bag_records.h"

#include <algorithm>

namespace eventide {

namespace {

class BagReader final : public RosReader {
public:
    BagReader(const std::string& path, const OpenOptions& options)
        : RosReader(path, options.stream), records_(path), begin_(records_.position()) {
        open("rosbag", options);
    }

    double progress() const override {
        return double(records_.position()) / double(std::max<std::uint64_t>(records_.size(), 1));
    }

    void seek(SensorTime t) override {
        begin_anew();
        if (!has_whole_times()) return;
        const std::vector<std::uint64_t> places = places_of_messages();
        if (!index_is_read_) return begin_anew();  // topics may be told where it does not read
        std::size_t first = 0, count = places.size();
        while (count > 0) {
            const std::size_t half = count / 2;
            const auto found = first_time_from(places[first + half]);
            if (found && *found < t) {
                first += half + 1;
                count -= half + 1;
            } else {
                count = half;
            }
        }
        begin_anew();
        // The one before begins earlier and may end later.
        if (first > 0) records_.go_to(places[first - 1]);
    }

protected:
    bool read_part(Damage& damage) override {
        const std::uint64_t before = records_.position();
        try {
            return records_.read([this](const BagRecord& record) { take(record); });
        } catch (const BagError& error) {
            damage.count(error.reason());
            const bool goes_on = error.reason() == DamageReason::bad_compression ||
                                 error.reason() == DamageReason::bad_record;
            return goes_on && records_.position() > before;
        }
    }
    void rewind() override { records_.go_to(begin_); }

private:
    void take(const BagRecord& record) {
        if (record.op == BagRecord::message)
            return add_message(records_.number(record, "conn"), record.data);
        if (record.op != BagRecord::connection) return;
        // Its data are fields once more, the type among them.
        const auto fields = bag_fields(record.data);
        const auto type = fields.find("type");
        const auto name = record.fields.find("topic");
        if (type != fields.end())
            add_topic(records_.number(record, "conn"),
                      name == record.fields.end() ? std::string_view{} : name->second, type->second,
                      RosWire::ros1);
    }

    /// Of chunks, and of messages that lie in none. Takes the topics that the index behind them
    /// tells: a chunk that is passed over may be the only other place of one.
    std::vector<std::uint64_t> places_of_messages() {
        std::vector<std::uint64_t> places;
        try {
            for (;;) {
                const std::uint64_t place = records_.position();
                const int op = records_.skip();
                if (op < 0) break;
                if (op == BagRecord::chunk || op == BagRecord::message) places.push_back(place);
                if (op != BagRecord::connection) continue;
                records_.go_to(place);
                records_.read([this](const BagRecord& record) { take(record); });
                index_is_read_ = true;
            }
        } catch (const BagError&) {  // counted by who reads on to there
        }
        return places;
    }

    std::optional<SensorTime> first_time_from(std::uint64_t place) {
        Damage unused;
        messages_.clear();
        records_.go_to(place);
        while (read_part(unused)) {
            for (const Message& message : messages_)
                if (const auto t = message.form.kind == RosKind::events
                                       ? first_time(message.form.wire, message.bytes)
                                       : std::nullopt)
                    return t;
            messages_.clear();
        }
        return {};
    }

    BagRecords records_;
    const std::uint64_t begin_;
    bool index_is_read_ = false;
};

}  // namespace

std::unique_ptr<DataReader> open_bag(const std::string& path, const OpenOptions& options) {
    return std::make_unique<BagReader>(path, options);
}

}  // namespace eventide
