// Frames as ROS 2 topics.
#include "pipeline/ros2/ros2_sink.h"

#include "pipeline/ros2/diagnostics_topic.h"
#include "pipeline/ros2/message_parts.h"
#include "pipeline/ros2/participant.h"
#include "pipeline/ros2/socket_buffer.h"
#include "pipeline/ros2/stamp_clock.h"
#include "pipeline/sinks/draw_frame.h"
#include "src/core/error.h"
#include "src/io/image_codecs.h"

#include <chrono>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace eventide {

namespace {

using Bytes = std::vector<std::uint8_t>;

std::size_t pixel_bytes(ImageEncoding encoding) {
    switch (encoding) {
        case ImageEncoding::mono8:
            return 1;
        case ImageEncoding::mono16:
            return 2;
        case ImageEncoding::float32:
            return 4;
    }
    return 0;
}

/// [y][x] as the encoding has it; `white` only matters for whole numbers, which are clamped.
void encode(const Array2<float>& image, ImageEncoding encoding, Bytes& into) {
    const auto values = image.values();
    into.resize(values.size() * pixel_bytes(encoding));
    switch (encoding) {
        case ImageEncoding::mono8:
            return to_grey8(values, 1, into);
        case ImageEncoding::mono16:
            return to_grey16(values, 1,
                             {reinterpret_cast<std::uint16_t*>(into.data()), values.size()});
        case ImageEncoding::float32:
            std::copy(values.begin(), values.end(), reinterpret_cast<float*>(into.data()));
    }
}

/// One image topic, and the bytes of its last image.
class ImageTopic {
public:
    ImageTopic(std::shared_ptr<Participant> participant, const std::string& ros_name,
               ImageEncoding encoding)
        : writer{std::move(participant), kImageType, ros_name},
          encoding_{encoding},
          encoding_name_{name_of(encoding)} {}

    void write(const Array2<float>& image, const std_msgs_msg_dds__Header_& header) {
        encode(image, encoding_, bytes_);
        sensor_msgs_msg_dds__Image_ message{};
        message.header = header;
        message.height = std::uint32_t(image.height());
        message.width = std::uint32_t(image.width());
        message.encoding = borrowed(encoding_name_);
        message.is_bigendian = std::endian::native == std::endian::big;
        message.step = std::uint32_t(std::size_t(image.width()) * pixel_bytes(encoding_));
        borrow(message.data, bytes_);
        writer.write(&message);
    }

    Ros2Writer writer;

private:
    ImageEncoding encoding_;
    std::string encoding_name_;
    Bytes bytes_;
};

/// image_raw/compressed, as compressed_image_transport writes it.
class CompressedTopic {
public:
    CompressedTopic(std::shared_ptr<Participant> participant, const std::string& ros_name,
                    ImageEncoding encoding, ImageCompression compression)
        : writer{std::move(participant), kCompressedImageType, ros_name},
          encoding_{encoding},
          extension_{compression == ImageCompression::jpeg ? ".jpg" : ".png"} {
        load_image_codecs();
        const std::string name{name_of(encoding)};
        format_ = name + (compression == ImageCompression::jpeg ? "; jpeg" : "; png") +
                  " compressed " + name;
    }

    void write(const Array2<float>& image, const std_msgs_msg_dds__Header_& header) {
        encode(image, encoding_, pixels_);
        const cv::Mat pixels(image.height(), image.width(),
                             encoding_ == ImageEncoding::mono8 ? CV_8UC1 : CV_16UC1,
                             pixels_.data());
        if (!encode_image(extension_, pixels, bytes_))
            throw Error(ErrorKind::failed, "ros2: OpenCV cannot write " + extension_);
        sensor_msgs_msg_dds__CompressedImage_ message{};
        message.header = header;
        message.format = borrowed(format_);
        borrow(message.data, bytes_);
        writer.write(&message);
    }

    Ros2Writer writer;

private:
    ImageEncoding encoding_;
    std::string extension_, format_;
    Bytes pixels_, bytes_;
};

class InfoTopic {
public:
    InfoTopic(std::shared_ptr<Participant> participant, const std::string& ros_name,
              Calibration calibration, ImageGeometry geometry)
        : writer{std::move(participant), kCameraInfoType, ros_name},
          calibration_{std::move(calibration)},
          geometry_{geometry} {}

    void write(int width, int height, const std_msgs_msg_dds__Header_& header) {
        const Calibration now = fitted(calibration_, geometry_, width, height);
        sensor_msgs_msg_dds__CameraInfo_ message{};
        message.header = header;
        message.height = std::uint32_t(now.height);
        message.width = std::uint32_t(now.width);
        message.distortion_model = borrowed(now.distortion_model);
        borrow(message.d, now.d);
        std::ranges::copy(now.k, message.k);
        std::ranges::copy(now.r, message.r);
        std::ranges::copy(now.p, message.p);
        writer.write(&message);
    }

    Ros2Writer writer;

private:
    Calibration calibration_;
    ImageGeometry geometry_;
};

/// ROS time is that of the system's clock.
SensorDuration system_ahead() {
    using namespace std::chrono;
    return duration_cast<SensorDuration>(system_clock::now().time_since_epoch() -
                                         steady_clock::now().time_since_epoch());
}

Calibration calibration_of(const Ros2SinkSettings& settings) {
    if (settings.calibration) return *settings.calibration;
    if (settings.name.calibration.empty()) return {};
    return read_calibration(settings.name.calibration, settings.name.calibration_camera);
}

class Ros2Sink final : public Sink {
public:
    explicit Ros2Sink(Ros2SinkSettings settings)
        : settings_{std::move(settings)},
          // Before anybody is told that we are there.
          calibration_{calibration_of(settings_)},
          participant_{Participant::join()},
          image_{participant_, topic("/image_raw"), settings_.name.encoding},
          info_{participant_, topic("/camera_info"), calibration_, settings_.geometry},
          diagnostics_{participant_, settings_.name.name_space},
          clock_{settings_.name.stamp, settings_.live} {
        if (settings_.with_sigma)
            sigma_.emplace(participant_, topic("/uncertainty"), settings_.name.uncertainty);
        if (settings_.name.compressed != ImageCompression::none)
            compressed_.emplace(participant_, topic("/image_raw/compressed"),
                                settings_.name.encoding, settings_.name.compressed);
        if (!participant_->warnings().empty() && settings_.detail)
            settings_.detail(label() + "Cyclone DDS: " + participant_->warnings());
    }

    void write(const Frame& frame) override {
        const bool first = !begun_;
        if (first && !begin(frame)) return;
        const std::int64_t stamp = clock_.stamp_us(frame, system_ahead());
        tell_offset(frame, stamp);
        const auto header = header_of(stamp, settings_.name.frame_id);
        if (image_.writer.readers() > 0) image_.write(frame.intensity, header);
        if (sigma_ && sigma_->writer.readers() > 0 && !frame.sigma.empty())
            sigma_->write(frame.sigma, header);
        if (info_.writer.readers() > 0)
            info_.write(frame.intensity.width(), frame.intensity.height(), header);
        if (compressed_ && compressed_->writer.readers() > 0)
            compressed_->write(frame.intensity, header);
        // Subscribers that were waited for may still be on their way to finding us: the first frame
        // is kept for them until they have it.
        if (first && settings_.name.subscribers > 0)
            image_.writer.wait_for_readers_to_take_all(kLastTimeout);
    }

    void lookahead_is(int windows) override { clock_.set_lookahead(windows); }

    bool is_watched() const override {
        if (!settings_.name.lazy) return true;
        // Who waits for subscribers waits before the first frame.
        return (!begun_ && settings_.name.subscribers > 0) || image_.writer.readers() > 0 ||
               info_.writer.readers() > 0 || (sigma_ && sigma_->writer.readers() > 0) ||
               (compressed_ && compressed_->writer.readers() > 0);
    }

    void close() override {
        const auto until = std::chrono::steady_clock::now() + kLastTimeout;  // for all together
        for (Ros2Writer* writer : writers())
            writer->wait_for_readers_to_take_all(
                std::chrono::duration_cast<std::chrono::milliseconds>(
                    std::max(until - std::chrono::steady_clock::now(),
                             std::chrono::steady_clock::duration{0})));
    }

private:
    static constexpr std::chrono::milliseconds kLastTimeout{1000};

    std::string topic(const char* name) const { return settings_.name.name_space + name; }

    std::vector<Ros2Writer*> writers() {
        std::vector<Ros2Writer*> all{&image_.writer, &info_.writer, &diagnostics_.writer};
        if (sigma_) all.push_back(&sigma_->writer);
        if (compressed_) all.push_back(&compressed_->writer);
        return all;
    }

    /// False when it was given up.
    bool begin(const Frame& frame) {
        if (!image_.writer.wait_for_readers(settings_.name.subscribers, settings_.give_up))
            return false;
        begun_ = true;
        const std::size_t pixels = frame.intensity.values().size();
        std::size_t bytes = pixels * pixel_bytes(settings_.name.encoding);
        if (sigma_) bytes = std::max(bytes, pixels * pixel_bytes(settings_.name.uncertainty));
        const std::size_t most = largest_socket_buffer();
        if (!fits_socket_buffer(bytes, most))
            warn("an image of " + std::to_string(bytes) +
                 " bytes is larger than the socket buffer that net.core.rmem_max = " +
                 std::to_string(most) +
                 " allows: best-effort subscribers would get none; on their machines: " +
                 socket_buffer_command(bytes));
        return true;
    }

    void tell_offset(const Frame& frame, std::int64_t stamp_us) {
        if (clock_.is_set_anew()) say(offset_words(clock_.offset_us()));
        diagnostics_.tell({stamp_us, to_us(frame.t), clock_.offset_us(), clock_.is_set_anew()});
    }

    void say(const std::string& text) const {
        if (settings_.say) settings_.say(label() + text);
    }
    void warn(const std::string& text) const {
        if (settings_.warn) settings_.warn(label() + text);
    }
    std::string label() const { return "ros2:" + settings_.name.name_space + ": "; }

    Ros2SinkSettings settings_;
    Calibration calibration_;
    std::shared_ptr<Participant> participant_;
    ImageTopic image_;
    std::optional<ImageTopic> sigma_;
    InfoTopic info_;
    DiagnosticsTopic diagnostics_;
    std::optional<CompressedTopic> compressed_;
    StampClock clock_;
    bool begun_ = false;
};

}  // namespace

std::unique_ptr<Sink> open_ros2_sink(Ros2SinkSettings settings) {
    return std::make_unique<Ros2Sink>(std::move(settings));
}

}  // namespace eventide
