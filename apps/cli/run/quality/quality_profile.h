// What a network costs on this processor: measured once, kept as a file.
#pragma once

#include <eventide/arithmetic.h>

#include <optional>
#include <string>
#include <vector>

namespace eventide::app {

/// Processor time of one thread in ms, every tile computed.
struct PrecisionCost {
    Precision precision = Precision::f32;
    std::string engine;    ///< "fast, bf16 (AMX)"
    double encode_ms = 0;  ///< an event window
    double first_ms = 0;   ///< once more for each event window that frames are rendered of
    /// A frame of the sensor's size, of half of it and of a third each way. Pixels that lie on the
    /// codes read one each way, those between them two: at half the size nothing is saved.
    double full_ms = 0, half_ms = 0, third_ms = 0;
};

/// What the figures hold for: where any of it differs, they are measured anew.
struct ProfileKey {
    std::string processor;      ///< its name and instructions
    std::string instructions;   ///< those our kernels use: "AVX-512, bf16 (AMX)"
    std::string kernels;        ///< --kernels
    std::string version;        ///< of eventide
    std::string model;          ///< its name, for people
    std::string identity;       ///< model_identity()
    int width = 0, height = 0;  ///< px, of the sensor
    friend bool operator==(const ProfileKey&, const ProfileKey&) = default;
};

struct QualityProfile {
    ProfileKey key;
    std::vector<PrecisionCost> costs;  ///< f32 first; at least one

    /// Null where it was not measured.
    const PrecisionCost* of(Precision precision) const;
};

std::string profile_text(const QualityProfile& profile);

/// What profile_text() wrote for this key. Throws Error (input) saying what is damaged, or what of
/// the key differs.
QualityProfile parse_profile(const std::string& text, const ProfileKey& key);

}  // namespace eventide::app
