// What all cameras on USB do alike: open, start, stream, survive being unplugged, stop. What
// differs, registers above all, is in a few functions of each kind.
#pragma once

#include "drivers/camera.h"
#include "drivers/usb/usb_device.h"
#include "drivers/usb/usb_stream.h"
#include "drivers/wait_warnings.h"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace eventide {

/// What the camera needs between the steps of a start (docs/protocols.md A.8): the device's
/// waits, not ours. A camera in software needs none.
struct UsbWaits {
    std::chrono::milliseconds idle{10}, biases_settle{200}, flow_settles{50};
};

/// Which camera, and what is to happen when it is unplugged.
struct UsbCameraOptions {
    std::string serial;          ///< empty: the first camera that can be used
    int bus = -1, address = -1;  ///< -1: any
    /// Open the camera again, once it is back or works again, instead of ending with an error.
    bool reconnect = false;
    std::function<void(const std::string&)> warn = {};  ///< as CameraOptions::warn
    UsbWaits waits;
};

/// A kind of camera, as the bus shows it.
struct UsbKind {
    const char* name;    ///< in messages and lists: "DAVIS"
    const char* scheme;  ///< of its sources: "davis:"
    std::vector<std::uint16_t> products;
    std::uint8_t data_endpoint = 0x82;
};

class UsbCamera : public Camera {
public:
    const SensorInfo& info() const override { return info_; }
    ReadStatus read(RawPacket& into) final;
    std::size_t packet_bytes() const final;
    void stop() noexcept final;
    const std::string& logic() const { return logic_; }  ///< "18 patch 1"; empty where it has none

protected:
    UsbCamera(UsbKind kind, UsbCameraOptions options, UsbStreamSettings transfers);

    /// They call the virtual functions below: a derived class calls open() at the end of its
    /// constructor, and stop_device() at the beginning of its destructor.
    void open();
    void stop_device() noexcept;

    // What a kind does, in the order in which it happens. All throw Error (device).

    /// The camera was opened: is it one that can be used, what is it, and is it set as was asked?
    virtual SensorInfo set_up(UsbDevice& device) = 0;
    /// Makes no data: the first step of a start and of a stop.
    virtual void make_idle(UsbDevice& device) = 0;
    /// Makes data; transfers wait for them.
    virtual void start_data(UsbDevice& device) = 0;
    /// Its time begins, and the stream shows where.
    virtual void reset_time(UsbDevice& device) = 0;
    /// Where in these bytes, which begin with a whole word, its time begins.
    virtual std::optional<std::size_t> find_begin(std::span<const std::byte> bytes) const = 0;
    virtual std::size_t word_bytes() const { return 2; }
    /// Where it says things beside its data (interrupt IN); 0: nowhere, or nobody asks. What it
    /// says there becomes words of the data's stream, in place.
    virtual std::uint8_t message_endpoint() const { return 0; }
    virtual void frame_message(std::vector<std::byte>&) const {}
    /// Undoes what set_up() switched on: the last step of a stop.
    virtual void power_down(UsbDevice&) {}
    /// Events that it dropped itself since it was powered.
    virtual std::uint64_t dropped(UsbDevice&) { return 0; }
    virtual void between_transfers(UsbDevice&) {}

    const UsbWaits& waits() const { return options_.waits; }
    /// Throws where it is too old, or a second-generation board.
    void require_firmware(const UsbIdentity& identity, int oldest) const;
    /// Throws where it is not logic 18 of this patch or later.
    void require_logic(UsbDevice& device, std::uint32_t oldest_patch);
    /// Where it was opened before: throws where this is another camera, or one whose words mean
    /// something else. Before anything is set.
    void require_same(const SensorInfo& found, bool same_words) const;
    [[noreturn]] void refuse(const std::string& why) const;  ///< "the DAVIS '00000042' ..."

private:
    void start();
    bool wait_for_begin();
    ReadStatus read_stream(RawPacket& into);
    std::optional<std::uint64_t> drops_so_far();
    void look_at_drops();
    void leave_out_half_word(std::vector<std::byte>& bytes);
    void close();
    void expect_return_of(const UsbIdentity& identity);
    void look_for_namesakes(const UsbIdentity& identity);
    void leave(const std::function<void()>& how);
    ReadStatus lost();
    ReadStatus wait_for_return();

    UsbKind kind_;
    UsbCameraOptions options_;
    UsbSelector selector_;
    WaitWarnings warnings_;
    UsbStreamSettings transfers_;
    SensorInfo info_;
    std::string logic_;
    std::unique_ptr<UsbDevice> device_;
    std::unique_ptr<UsbStream> stream_;            ///< after device_: it must end first
    std::optional<std::vector<std::byte>> first_;  ///< bytes from where time began
    std::uint64_t dropped_until_now_ = 0;          ///< by the device, as far as was counted
    bool drops_are_told_ = false;                  ///< since it was started
    HostTime look_at_drops_{};                     ///< when next
    bool gap_ = false, reopened_ = false;
    std::atomic<bool> stopped_{false};
};

/// Every camera of a kind that is plugged in, with what keeps it from being used. Chip and logic
/// are known only to the camera itself, so `open` opens it for a moment.
std::vector<CameraDescription> list_usb_cameras(
    const UsbKind& kind,
    const std::function<std::unique_ptr<UsbCamera>(const UsbCameraOptions&)>& open);

}  // namespace eventide
