// Prophesee's .bias files: what Metavision saves of a sensor's biases.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace eventide {

struct Bias {
    std::string name;  ///< "bias_fo"
    std::int64_t value = 0;
    std::size_t line = 0;  ///< from 1
};

bool names_bias_file(const std::filesystem::path& file);

/// Lines of `VALUE % NAME`, the value decimal or 0x...; what follows the name behind another % is
/// passed over, as are empty lines and header lines, which begin with %. Throws Error (usage) with
/// file and line for anything else, for a name with two values, and for a file without a bias.
std::vector<Bias> read_bias_file(const std::filesystem::path& file);

}  // namespace eventide
