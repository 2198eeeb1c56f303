// Named blocks of float numbers in a safetensors file: read with every bound checked, and written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace eventide {

/// Row-major: the last index of `shape` is contiguous. An empty shape is a single number.
struct Tensor {
    std::vector<std::int64_t> shape;
    std::vector<float> values;  ///< as many as the product of `shape`
    bool bf16 = false;          ///< in the file, 2 bytes a number: rounded to the nearest bf16

    friend bool operator==(const Tensor&, const Tensor&) = default;
};

using Tensors = std::map<std::string, Tensor>;

struct TensorFile {
    std::map<std::string, std::string> metadata;
    Tensors tensors;

    friend bool operator==(const TensorFile&, const TensorFile&) = default;
};

/// How many numbers a shape holds; throws Error(input) where that is negative or overflows.
std::size_t element_count(std::span<const std::int64_t> shape);

/// "[16, 21, 3, 3]"
std::string shape_text(std::span<const std::int64_t> shape);

/// The file's bytes as tensors. `name` stands for the file in messages. Throws Error(input) where
/// the bytes are not a whole safetensors file of finite float32 or bfloat16 tensors; the message
/// names the tensor. Never reads outside `bytes` nor allocates more than a small multiple of their
/// number.
TensorFile parse_safetensors(std::span<const std::byte> bytes, const std::string& name);

/// Whether a file begins as one: with the length of a header that fits, and JSON. False for a pipe,
/// which can be read but once.
bool is_safetensors(const std::filesystem::path& path);

/// As parse_safetensors, from a file.
TensorFile read_safetensors(const std::filesystem::path& path);

std::vector<std::byte> format_safetensors(const TensorFile& file);

/// So that no reader ever sees half a file. Throws Error: failed where it cannot be written, usage
/// for a file that is there and may not be replaced.
void write_safetensors(const std::filesystem::path& path, const TensorFile& file,
                       bool overwrite = true);

}  // namespace eventide
