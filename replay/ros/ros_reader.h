// What the readers of all kinds of bags share: which topics are read, and their messages as data.
#pragma once

#include "replay/data_reader.h"
#include "replay/open_options.h"
#include "replay/ros/ros_data.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace eventide {

/// Reads the first topic with events (dvs_msgs/EventArray, prophesee_event_msgs/EventArray,
/// event_camera_msgs/EventPacket) that can be read, or OpenOptions::stream, and the first with
/// images (sensor_msgs/Image) of the events' size, of the same namespace if there is one; remarks
/// name what is left out.
class RosReader : public DataReader {
public:
    const StreamHeader& header() const override { return header_; }
    std::vector<std::string> remarks() const override { return remarks_; }
    /// One message, so that what is told by a message's place in the bag stays so.
    bool read(Batch& into, Damage& damage) override;
    /// Packets tell only parts of their times: what lies before is read, too.
    void seek(SensorTime) override { begin_anew(); }

protected:
    struct Message {
        RosForm form;
        std::uint32_t topic;
        std::vector<std::byte> bytes;
    };

    RosReader(std::string path, std::string wanted)
        : path_(std::move(path)), wanted_(std::move(wanted)) {}

    /// Reads until the sizes of events and images are known, and goes back. Of who derives, at the
    /// end of its constructor. Throws Error: input where there are no events, usage where there are
    /// none of the topic wanted.
    void open(std::string_view format, const OpenOptions& options);

    /// The next part of the bag, for add_topic() and add_message(). False at the end, also where
    /// damage, which it counts, leaves no way on.
    virtual bool read_part(Damage& damage) = 0;
    virtual void rewind() = 0;

    void add_topic(std::uint32_t number, std::string_view name, std::string_view type,
                   RosWire wire);
    void add_message(std::uint32_t number, std::span<const std::byte> bytes);
    void begin_anew();
    /// Whether what is read are packets, or nothing yet.
    bool has_whole_times() const;

    const std::string path_;
    RosData data_;
    std::deque<Message> messages_;  ///< of the part

private:
    struct Topic {
        std::string name;
        RosForm form = {};
        std::optional<RosImageSize> size = {};  ///< of images, where one was seen
        bool has_messages = false;              ///< some came
        bool is_void = false;                   ///< of events: none that can be read
    };
    void look_for_sizes(Damage& damage);
    void look_at(const Message& message, Damage& damage);
    bool choose_other_events();
    bool has_all_sizes() const;
    bool has_size_of_events(const Topic& topic) const;
    bool is_of_other_camera(const Topic& topic) const;
    void choose_images();
    bool is_read(std::uint32_t number) const;
    [[noreturn]] void refuse(const Damage& damage) const;
    [[noreturn]] void refuse_topic() const;
    void name_other_topics();

    const std::string wanted_;  // topic with events; empty: the first
    StreamHeader header_;
    std::vector<std::string> remarks_;
    std::map<std::uint32_t, Topic> topics_;  // by number, or connection
    std::set<std::string> types_;
    std::optional<std::uint32_t> events_, images_;
    bool images_refused_ = false, ended_ = false;
    bool opening_ = true;  ///< the images of all topics are looked at
};

}  // namespace eventide
