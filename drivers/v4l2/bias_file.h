// Prophesee's files of biases: what Metavision saves of a sensor's.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace eventide {

struct BiasLine {
    std::string name;  ///< "bias_fo"
    std::int64_t value = 0;
    std::string place;  ///< "x.bias:3", "x.json: ll_biases_state.bias[2]"
};

/// Whether the extension is that of a file of biases, .bias or .json.
bool names_bias_file(const std::filesystem::path& file);

/// A .bias file: lines of `VALUE % NAME`, the value decimal or 0x...; what follows the name behind
/// another % is passed over, as are empty lines and header lines, which begin with %. A .json file:
/// camera settings as Metavision 4 and later save them (OpenEB's device_state.proto), of which
/// ll_biases_state.bias, [{"name": ..., "value": ...}], is read. Throws Error (usage) with file and
/// place for anything else, for a name with two values, for a file without a bias, and for one of
/// more than 1 MiB, 1000 biases or 16 levels.
std::vector<BiasLine> read_bias_file(const std::filesystem::path& file);

}  // namespace eventide
