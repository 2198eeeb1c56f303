// A video node that exists only for this process and its children: an event sensor to capture from,
// or a loopback to write to (umockdev).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace eventide::testing_support {

struct V4l2NodeSettings {
    bool output = false;  ///< takes frames instead of giving them
    bool multi_planar = false;
    std::string card = "eventide testbed";
    std::uint32_t fourcc = 0;           ///< of a capture node
    int width = 0, height = 0;          ///< of a capture node's format
    std::vector<std::uint32_t> offers;  ///< formats a capture node can be set to
    bool streams = true;                ///< a capture node; else it can only be read from
    std::size_t buffer_bytes = 64 * 1024;
    std::uint32_t most_buffers = 4;
    std::uint32_t data_offset = 0;            ///< of a multi-planar buffer: bytes before the data
    int sensor_width = 0, sensor_height = 0;  ///< what /dev/v4l-subdev0 says; 0: it does not say
    std::vector<std::uint32_t> takes;         ///< formats an output node takes
    int refuse_format_with = 0;               ///< errno of every S_FMT; 0 none
    struct Control {
        std::int32_t minimum = 0, maximum = 0, value = 0;
        bool read_only = false, deaf = false;  ///< deaf: it keeps its value, and says so
        bool disabled = false;
    };
    std::map<std::string, Control> controls;
};

/// /dev/video0 (and the controls on it), and the sensor's subdevice, /dev/v4l-subdev0.
class V4l2Testbed {
public:
    explicit V4l2Testbed(V4l2NodeSettings settings);
    ~V4l2Testbed();
    V4l2Testbed(const V4l2Testbed&) = delete;
    V4l2Testbed& operator=(const V4l2Testbed&) = delete;

    /// Capture: what the sensor gives next, one buffer's content.
    struct Content {
        std::vector<std::byte> bytes;
        std::uint32_t skipped_before = 0;  ///< buffers the driver lost: a jump of the sequence
        bool error_flag = false;
        // Where the driver lies; empty: it says what is so.
        std::optional<std::uint32_t> says_bytes = {}, says_index = {};
    };
    void give(Content content);
    bool all_taken() const;
    /// From now on DQBUF fails with this errno; 0 works again.
    void fail_with(int error);
    /// The next so many requests of this name ("STREAMON") fail with this errno.
    void fail_next(const std::string& request, int error, int times = 1);

    /// Output: what was written, and the names of the ioctls in their order.
    std::vector<std::vector<std::byte>> written() const;
    std::vector<std::string> requests() const;
    /// The next so many writes end with this errno: busy, or EINTR for a signal.
    void refuse_writes(int count, int error);

    /// As a driver that was loaded again, or media-ctl, leaves it.
    void change_format(std::uint32_t fourcc, int width, int height);
    std::uint32_t fourcc() const;  ///< of a capture node now
    /// /dev/video0 is gone, or there again.
    void hide_node(bool hidden);
    /// Another device is there.
    void change_card(const std::string& card);
    /// The driver has none any more.
    void take_controls_away();
    V4l2NodeSettings::Control control(const std::string& name) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace eventide::testing_support
