// A model's networks in double precision: what the engine's numbers are held against.
#pragma once

#include "src/core/frame_data.h"
#include "src/model/encode/encoder.h"
#include "src/model/model_file.h"

#include <cstdint>
#include <memory>

namespace eventide::stress {

/// How far numbers are from double precision.
struct Distance {
    double worst = 0;    ///< |difference| over the larger of 1 and the map's largest; NaN where
                         ///< either has one
    double squares = 0;  ///< of the differences
    double power = 0;    ///< of double precision's numbers
    double lowest = 0, highest = 0;  ///< of them, and 0
    std::uint64_t compared = 0;

    void add(std::span<const float> fast, std::span<const double> exact);
    void add(const Distance& other);
    double rms() const;           ///< over that of double precision's numbers
    double rms_of_range() const;  ///< over their range
};

/// The recurrent network.
class DoubleNetwork {
public:
    virtual ~DoubleNetwork() = default;
    virtual Array3<double> step(const Array3<double>& grid) = 0;
    /// Takes over what the engine remembers, or forgets everything.
    virtual void go_on_from(const TensorFile& state) = 0;
    virtual void reset() = 0;
};

std::unique_ptr<DoubleNetwork> make_double(const Model& model, int height, int width);

Array3<double> in_double(const Array3<float>& map);

}  // namespace eventide::stress
