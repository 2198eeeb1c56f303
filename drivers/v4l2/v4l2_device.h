// A V4L2 capture node: format, and buffers in mapped memory. Facts:
// docs/protocols.md part C.
#pragma once

#include "pipeline/video_node.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

struct v4l2_format;

namespace eventide {

/// Chooses the format of a node from the one it has and those it offers (fourcc); empty: it stays
/// as it is.
using FormatChoice =
    std::function<std::optional<std::uint32_t>(std::uint32_t, std::span<const std::uint32_t>)>;

class V4l2Device {
public:
    enum class Status { data, timeout, lost };
    struct Filled {
        std::span<const std::byte> bytes;  ///< borrowed until the next read
        std::uint32_t sequence = 0;        ///< of the driver: a jump is a loss
        bool damaged = false;              ///< the driver says that the buffer may be incomplete
        std::string why{};                 ///< of `lost`: for people
    };

    /// Opens the node, sets its format as `choose` says, and starts streaming into `buffers` mapped
    /// buffers. Throws Error (device): not there, no permission, no capture device, no streaming,
    /// busy.
    V4l2Device(const std::filesystem::path& node, int buffers, const FormatChoice& choose);
    ~V4l2Device();
    V4l2Device(const V4l2Device&) = delete;
    V4l2Device& operator=(const V4l2Device&) = delete;

    const std::string& card() const { return card_; }
    std::uint32_t fourcc() const { return fourcc_; }
    int width() const { return width_; }  ///< of the format; event drivers may say 0 or nonsense
    int height() const { return height_; }

    /// Waits at most `timeout`, whatever the driver does.
    Status read(Filled& into, std::chrono::milliseconds timeout);

private:
    /// A buffer of the driver's, mapped into our memory for as long as this lives.
    class Buffer {
    public:
        Buffer(void* memory, std::size_t length)
            : bytes_{static_cast<std::byte*>(memory), length} {}
        Buffer(Buffer&& other) noexcept : bytes_{std::exchange(other.bytes_, {})} {}
        Buffer& operator=(Buffer&&) = delete;
        ~Buffer();
        std::span<const std::byte> bytes() const { return bytes_; }

    private:
        std::span<std::byte> bytes_;
    };
    void query();
    void choose_format(const FormatChoice& choose);
    void take_format(v4l2_format& format);
    void map_buffers(int wanted);
    void start_streaming();
    Status dequeue(Filled& into);
    int queue(std::uint32_t index);  ///< 0 or errno
    [[noreturn]] void fail(const std::string& what, int error,
                           const std::string& way_out = "") const;

    std::filesystem::path node_;
    FileDescriptor fd_;
    std::string card_;
    std::uint32_t type_ = 0;  ///< single or multi-planar capture
    std::uint32_t fourcc_ = 0;
    int width_ = 0, height_ = 0;
    std::vector<Buffer> buffers_;        ///< after fd_: unmapped before it is closed
    std::optional<std::uint32_t> held_;  ///< the buffer whose bytes are lent out
};

/// The formats that a node of this type (V4L2_BUF_TYPE_...) can be set to.
std::vector<std::uint32_t> offered_formats(int fd, std::uint32_t type);

std::string fourcc_text(std::uint32_t fourcc);

}  // namespace eventide
