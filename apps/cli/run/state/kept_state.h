// Words and tensors of a state file, which may have been written by anybody.
#pragma once

#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/core/sensor_limits.h"
#include "src/core/sensor_time.h"
#include "src/nn/safetensors.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace eventide::app {

/// File and name are borrowed. What is not there, or not what it should be, is refused: Error
/// (input) that names the file.
class KeptState {
public:
    KeptState(const TensorFile& file, const std::string& name) : file_{file}, name_{name} {}

    std::int64_t number(const std::string& key) const {
        const std::string text = word(key);
        const auto value = number_in<std::int64_t>(text);
        if (!value) refuse("'" + key + "': expected a whole number, found '" + text + "'");
        return *value;
    }
    /// Such that sums of times fit.
    SensorTime time(const std::string& key) const {
        const std::int64_t us = number(key);
        if (us < -kFarthestUs || us > kFarthestUs)
            refuse("'" + key + "': expected a time that a clock can have, found " +
                   std::to_string(us));
        return from_us(us);
    }
    std::optional<SensorTime> time_or_none(const std::string& key) const {
        if (word(key) == "none") return std::nullopt;
        return time(key);
    }
    std::string word(const std::string& key) const {
        const auto found = file_.metadata.find(key);
        if (found == file_.metadata.end()) refuse("expected '" + key + "', found none");
        return found->second;
    }
    bool has(const std::string& key) const { return file_.tensors.contains(key); }

    /// Whole numbers from `least` to `most`; a shape's -1 is any.
    const std::vector<float>& tensor(const std::string& key, std::vector<std::int64_t> shape,
                                     float least, float most) const {
        const auto found = file_.tensors.find(key);
        if (found == file_.tensors.end()) refuse("expected tensor '" + key + "', found none");
        const Tensor& tensor = found->second;
        for (std::size_t i = 0; i < shape.size() && i < tensor.shape.size(); ++i)
            if (shape[i] < 0) shape[i] = tensor.shape[i];
        if (tensor.shape != shape)
            refuse("tensor '" + key + "': expected shape " + shape_text(shape) + ", found " +
                   shape_text(tensor.shape));
        for (const float value : tensor.values)
            if (!(value >= least && value <= most && value == std::floor(value)))
                refuse("tensor '" + key + "': expected whole numbers from " +
                       std::to_string(std::int64_t(least)) + " to " +
                       std::to_string(std::int64_t(most)) + ", found " + std::to_string(value));
        return tensor.values;
    }
    [[noreturn]] void refuse(const std::string& words) const {
        throw Error(ErrorKind::input, name_ + ": state: " + words);
    }

private:
    const TensorFile& file_;
    const std::string& name_;
};

}  // namespace eventide::app
