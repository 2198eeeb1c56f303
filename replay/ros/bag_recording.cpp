// Messages of a bag, one at a time; chunks tell where a time lies.
#include "replay/ros/bag_recording.h"

#include "replay/ros/ros_data.h"
#include "src/core/error.h"
#include "src/io/bag_records.h"

#include <algorithm>
#include <deque>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace eventide {

namespace {

constexpr int kRecordsToLookAt = 64;  // for the first image, once the first event is found

struct Topic {
    std::string name;
    RosKind kind = RosKind::other;
};

struct Message {
    RosKind kind;
    std::vector<std::byte> bytes;
};

class BagReader final : public DataReader {
public:
    BagReader(const std::string& path, const OpenOptions& options)
        : path_(path), records_(path), data_(RosWire::ros1), begin_(records_.position()) {
        header_.format = "rosbag";
        look_at_beginning();
        header_.width = options.width > 0 ? options.width : data_.width();
        header_.height = options.width > 0 ? options.height : data_.height();
        go_to(begin_);
    }

    const StreamHeader& header() const override { return header_; }
    std::vector<std::string> remarks() const override { return remarks_; }
    double progress() const override {
        return double(records_.position()) / double(std::max<std::uint64_t>(records_.size(), 1));
    }

    /// One message, so that what is told by a message's place in the bag stays so.
    bool read(Batch& into, Damage& damage) override {
        while (messages_.empty())
            if (!read_record(damage)) return false;
        const Message message = std::move(messages_.front());
        messages_.pop_front();
        data_.take(message.kind, message.bytes, into, damage);
        return true;
    }

    /// Packets tell only parts of their times: what lies before is read, too.
    void seek(SensorTime t) override {
        go_to(begin_);
        if (!events_ || topics_[*events_].kind != RosKind::events) return;
        const std::vector<std::uint64_t> places = places_of_messages();
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
        // The one before begins earlier and may end later.
        go_to(first == 0 ? begin_ : places[first - 1]);
    }

private:
    void go_to(std::uint64_t position) {
        records_.go_to(position);
        messages_.clear();
        data_.restart();
        ended_ = false;
    }

    /// False at the end, also where damage leaves no way on.
    bool read_record(Damage& damage) {
        if (ended_) return false;
        const std::uint64_t before = records_.position();
        try {
            if (records_.read([this](const BagRecord& record) { take(record); })) return true;
        } catch (const BagError& error) {
            damage.count(error.reason());
            const bool goes_on = error.reason() == DamageReason::bad_compression ||
                                 error.reason() == DamageReason::bad_record;
            if (goes_on && records_.position() > before) return true;
        }
        ended_ = true;
        return !messages_.empty();
    }

    void take(const BagRecord& record) {
        if (record.op == BagRecord::connection) take_connection(record);
        if (record.op != BagRecord::message) return;
        const std::uint32_t number = records_.number(record, "conn");
        if (!is_read(number)) return;
        messages_.push_back(
            {topics_[number].kind, std::vector(record.data.begin(), record.data.end())});
    }

    /// A topic has a connection for each of its publishers.
    bool is_read(std::uint32_t number) const {
        const auto found = topics_.find(number);
        const auto is_topic_of = [&](const std::optional<std::uint32_t>& chosen) {
            return chosen && found->second.name == topics_.at(*chosen).name &&
                   found->second.kind == topics_.at(*chosen).kind;
        };
        return found != topics_.end() && (is_topic_of(events_) || is_topic_of(images_));
    }

    /// Its data are fields once more, the type among them.
    void take_connection(const BagRecord& record) {
        const std::uint32_t number = records_.number(record, "conn");
        if (topics_.contains(number)) return;
        const auto fields = bag_fields(record.data);
        const auto type = fields.find("type");
        const auto name = record.fields.find("topic");
        if (type == fields.end()) return;
        Topic& topic = topics_[number];
        topic = {name == record.fields.end() ? "" : std::string(name->second),
                 ros_kind(type->second)};
        types_.insert(std::string(type->second));
        if (topic.kind == RosKind::images && !images_ && !images_refused_) images_ = number;
        if ((topic.kind == RosKind::events || topic.kind == RosKind::packets) && !events_)
            events_ = number;
    }

    /// Until the sizes of events and images are known.
    void look_at_beginning() {
        Damage unused;
        Batch batch;
        for (int records = 0; data_.width() == 0 || records < kRecordsToLookAt; ++records) {
            if (!read_record(unused)) break;
            for (const Message& message : messages_)
                if (message.kind == RosKind::images ? data_.image_width() == 0 : data_.width() == 0)
                    data_.take(message.kind, message.bytes, batch, unused);
            messages_.clear();
            batch.clear();
            if (data_.width() > 0 && (data_.image_width() > 0 || !images_)) break;
        }
        if (data_.width() == 0) refuse(unused);
        leave_out_other_images();
        name_other_topics();
    }

    [[noreturn]] void refuse(const Damage& damage) const {
        std::string types;
        for (const std::string& type : types_) types += (types.empty() ? "" : ", ") + type;
        throw Error(ErrorKind::input,
                    path_ +
                        ": expected messages with events (dvs_msgs/EventArray, "
                        "prophesee_event_msgs/EventArray, event_camera_msgs/EventPacket), found " +
                        (types.empty() ? "none" : types) +
                        (damage.total() > 0 ? ", and damage" : ""));
    }

    void leave_out_other_images() {
        if (data_.image_width() == 0 ||
            (data_.image_width() == data_.width() && data_.image_height() == data_.height()))
            return;
        remarks_.push_back("the images of " + topics_[*images_].name + " are left out: they are " +
                           std::to_string(data_.image_width()) + "x" +
                           std::to_string(data_.image_height()) + " px, the events' sensor has " +
                           std::to_string(data_.width()) + "x" + std::to_string(data_.height()));
        images_.reset();
        images_refused_ = true;
    }

    void name_other_topics() {
        for (const auto& [number, topic] : topics_)
            if (!is_read(number) &&
                (topic.kind == RosKind::events || topic.kind == RosKind::packets))
                remarks_.push_back("the events of " + topic.name + " are left out, those of " +
                                   topics_[*events_].name + " are read");
    }

    /// Of chunks, and of messages that lie in none; takes the connections on the way.
    std::vector<std::uint64_t> places_of_messages() {
        std::vector<std::uint64_t> places;
        try {
            for (;;) {
                const std::uint64_t place = records_.position();
                const int op = records_.skip();
                if (op < 0) break;
                if (op == BagRecord::chunk || op == BagRecord::message) places.push_back(place);
            }
        } catch (const BagError&) {  // counted by who reads on to there
        }
        return places;
    }

    std::optional<SensorTime> first_time_from(std::uint64_t place) {
        Damage unused;
        go_to(place);
        while (read_record(unused)) {
            for (const Message& message : messages_)
                if (const auto t = message.kind == RosKind::events ? data_.first_time(message.bytes)
                                                                   : std::nullopt)
                    return t;
            messages_.clear();
        }
        return {};
    }

    const std::string path_;
    BagRecords records_;
    RosData data_;
    const std::uint64_t begin_;
    StreamHeader header_;
    std::vector<std::string> remarks_;
    std::map<std::uint32_t, Topic> topics_;  // by connection
    std::set<std::string> types_;
    std::optional<std::uint32_t> events_, images_;
    std::deque<Message> messages_;  // of one chunk
    bool images_refused_ = false, ended_ = false;
};

}  // namespace

std::unique_ptr<DataReader> open_bag(const std::string& path, const OpenOptions& options) {
    return std::make_unique<BagReader>(path, options);
}

}  // namespace eventide
