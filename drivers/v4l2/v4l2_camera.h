// An event sensor on an embedded board, behind a V4L2 driver, as a source of EVT words.
#pragma once

#include "drivers/camera.h"
#include "drivers/devices.h"
#include "drivers/v4l2/v4l2_device.h"
#include "drivers/wait_warnings.h"

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace eventide {

/// How the words in the buffers are coded.
enum class EvtEncoding {
    evt2,           ///< fourcc PSEE
    evt21_swapped,  ///< PSE1: EVT2.1 with the 32-bit halves swapped ("middle-endian")
    evt21,          ///< PSE2
    evt3            ///< PSE3
};

/// The encoding a pixel format stands for; empty for formats that say nothing (the Raspberry Pi's
/// receiver shows GREY).
std::optional<EvtEncoding> encoding_of(std::uint32_t fourcc);

struct V4l2Settings {
    std::optional<EvtEncoding> encoding;  ///< where the driver does not say, or offers several
    int width = 0, height = 0;            ///< px; 0: from the subdevice, else from the format
    std::filesystem::path
        subdevice;  ///< "/dev/v4l-subdev0": has the controls and the sensor's size
    std::map<std::string, std::int64_t>
        controls;  ///< by the driver's names: bias_fo, erc_enable, ...
    std::map<std::string, std::string> control_places;  ///< where each was said: "x.bias:3"
    int buffers = 32;
};

/// config/cameras/*.toml, or a .bias or .json file of Prophesee's, whose names are the driver's.
/// Unknown keys are refused with file and line (Error, usage).
V4l2Settings load_v4l2_settings(const std::filesystem::path& file);

/// The bytes before the end-of-data word that the Raspberry Pi's driver puts after the last good
/// one, where its receiver always hands over whole "frames". All bytes where there is none.
std::span<const std::byte> before_end_of_data(std::span<const std::byte> bytes,
                                              EvtEncoding encoding);

class V4l2Camera final : public Camera {
public:
    /// `warn`: as CameraOptions::warn.
    V4l2Camera(std::filesystem::path node, V4l2Settings settings, bool reconnect,
               std::function<void(const std::string&)> warn = {});

    const SensorInfo& info() const override { return info_; }
    ReadStatus read(RawPacket& into) override;
    void stop() noexcept override { stopped_ = true; }
    std::unique_ptr<Parser> make_parser() const override;

private:
    void open();
    std::optional<std::uint32_t> choose_format(std::uint32_t now,
                                               std::span<const std::uint32_t> offered) const;
    EvtEncoding encoding_given() const;
    void note_sequence(std::uint32_t sequence);
    void require_same(const SensorInfo& found) const;
    ReadStatus lost(const std::string& why);
    ReadStatus wait_for_return();

    std::filesystem::path node_;
    V4l2Settings settings_;
    bool reconnect_;
    WaitWarnings warnings_;
    SensorInfo info_;
    EvtEncoding encoding_ = EvtEncoding::evt3;
    std::uint32_t fourcc_ = 0;  ///< of the node, once it was opened
    std::unique_ptr<V4l2Device> device_;
    std::optional<std::uint32_t> last_sequence_;
    bool gap_ = false;
    bool reopened_ = false;  ///< and has given nothing since
    std::atomic<bool> stopped_{false};
};

std::unique_ptr<Camera> open_v4l2(std::string_view node, const CameraOptions& options);

/// Capture nodes whose format is one of event data, or can be.
std::vector<CameraDescription> list_v4l2_cameras();

}  // namespace eventide
