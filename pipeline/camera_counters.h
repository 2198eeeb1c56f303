// What a camera's driver counts, and what each count is called wherever it is told: on the status
// line, in --stats, run.json and the summary, on the live page and in its /metrics.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace eventide {

/// A transfer is one of USB, a buffer of V4L2, a datagram or a message of ROS 2.
enum class CameraCount : std::uint8_t {
    transfers,
    bytes,
    dropped_events,     ///< by the camera itself, as its own counter says
    lost_transfers,     ///< not taken in time, as far as the system or the sender numbers them
    damaged_transfers,  ///< delivered with an error
    cut_transfers,      ///< ended within a word, which was left out
    stalls,             ///< of the data endpoint, which was cleared and went on
    reconnects,         ///< times it was lost and came back
    kCount
};

constexpr std::size_t kCameraCounts = std::size_t(CameraCount::kCount);

/// What happened: data came, something came out of step, data were lost.
enum class CameraCountKind : std::uint8_t { traffic, incident, loss };

struct CameraCountWords {
    std::string_view name, brief;  ///< in JSON and metrics; where columns are few
    CameraCountKind kind;
    std::string_view help;  ///< a sentence
};

/// [CameraCount]
inline constexpr std::array<CameraCountWords, kCameraCounts> kCameraCountWords{
    {{"transfers", "", CameraCountKind::traffic,
      "USB transfers, buffers, datagrams or messages of the camera."},
     {"bytes", "", CameraCountKind::traffic, "Bytes of the camera's transfers."},
     {"dropped_events", "drop", CameraCountKind::loss, "Events that the camera itself dropped."},
     {"lost_transfers", "lost", CameraCountKind::loss,
      "Transfers of the camera that were not taken in time."},
     {"damaged_transfers", "dam", CameraCountKind::loss,
      "Transfers of the camera that came with an error."},
     {"cut_transfers", "cut", CameraCountKind::loss,
      "Transfers of the camera that ended within a word."},
     {"stalls", "stall", CameraCountKind::incident, "Times the camera's data endpoint stalled."},
     {"reconnects", "back", CameraCountKind::incident,
      "Times the camera was lost and came back."}}};

constexpr const CameraCountWords& words_of(CameraCount count) {
    return kCameraCountWords[std::size_t(count)];
}

/// The counts at one moment.
class CameraCounters {
public:
    void set(CameraCount count, std::uint64_t n) { counts_[std::size_t(count)] = n; }
    std::uint64_t operator[](CameraCount count) const { return counts_[std::size_t(count)]; }
    bool lost_data() const {
        for (std::size_t i = 0; i < kCameraCounts; ++i)
            if (counts_[i] > 0 && words_of(CameraCount(i)).kind == CameraCountKind::loss)
                return true;
        return false;
    }

private:
    std::array<std::uint64_t, kCameraCounts> counts_{};
};

}  // namespace eventide
