// IMU words of AEDAT 2.0 -> samples.
#include "src/codec/aedat/aedat2_imu.h"

namespace eventide {

namespace {

// docs/protocols.md D.1: full scales of 4 g and 500 deg/s.
constexpr float kLsbPerG = 8192;
constexpr float kLsbPerDps = 65.5F;
constexpr unsigned kAll = 0x7F, kTemperature = 1U << 3;

}  // namespace

void Aedat2ImuAssembler::word(unsigned measure, std::int16_t value, SensorTime t, Batch& into,
                              Damage& damage) {
    if (measure > 6) {
        damage.count(DamageReason::unknown_word);
        return;
    }
    // Measures come in order: an earlier one, or another time, begins a new sample.
    const bool begins = seen_ >> measure != 0 || t != sample_.t;
    if (seen_ != 0 && begins) damage.count(DamageReason::bad_record);
    if (seen_ == 0 || begins) {
        sample_ = {};
        sample_.t = t;
        seen_ = 0;
    }
    seen_ |= 1U << measure;
    if (measure < 3)
        sample_.acceleration_g[measure] = float(value) / kLsbPerG;
    else if (measure == 3)
        sample_.temperature_c = float(value) / 340 + 35;
    else
        sample_.gyro_dps[measure - 4] = float(value) / kLsbPerDps;
    if (measure != 6) return;
    if ((seen_ | kTemperature) == kAll)
        into.imu.push_back(sample_);
    else
        damage.count(DamageReason::bad_record);
    seen_ = 0;
}

void Aedat2ImuAssembler::finish(Damage& damage) {
    if (seen_ != 0) damage.count(DamageReason::truncated);
    seen_ = 0;
}

}  // namespace eventide
