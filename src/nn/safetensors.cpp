// safetensors: 8 bytes length (little endian), that many bytes of JSON, then the raw numbers.
//
//     byte    0         8                             8 + n
//             n         {"encoder.in.bias": {...},    numbers of one tensor after the other, which
//                       ...}, spaces                  data_offsets count from here
//
// An entry: {"dtype": "F32", "shape": [16, 21, 3, 3], "data_offsets": [0, 12096]}
#include "src/nn/safetensors.h"

#include "src/core/error.h"
#include "src/core/list_text.h"
#include "src/io/input_file.h"
#include "src/io/output_file.h"
#include "src/kernels/bf16_kernels.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <set>
#include <system_error>

namespace eventide {
namespace {

using Json = nlohmann::json;

static_assert(std::endian::native == std::endian::little, "tensors are stored little endian");

constexpr std::size_t kLengthBytes = 8;
/// The format's own limit on the header.
constexpr std::uint64_t kMaxHeaderBytes = 100'000'000;
constexpr std::size_t kMaxDimensions = 8;

[[noreturn]] void refuse(const std::string& file, const std::string& what) {
    throw Error(ErrorKind::input, file + ": " + what);
}

/// Parses the header; a key that comes twice is refused, since readers would differ on which wins.
Json parse_header(std::string_view text, const std::string& file) {
    std::set<std::string> names;
    std::string twice;
    const auto watch = [&](int depth, Json::parse_event_t event, Json& parsed) {
        if (event == Json::parse_event_t::key && depth == 1) {
            const auto& key = parsed.get_ref<const std::string&>();
            if (!names.insert(key).second) twice = key;
        }
        return true;
    };
    Json header = Json::parse(text, watch, /*allow_exceptions=*/false);
    if (header.is_discarded() || !header.is_object())
        refuse(file, "not a safetensors file: its header is not a JSON object");
    if (!twice.empty()) refuse(file, "tensor '" + twice + "' is described twice");
    return header;
}

std::map<std::string, std::string> parse_metadata(const Json& json, const std::string& file) {
    if (!json.is_object()) refuse(file, "__metadata__ is not an object");
    std::map<std::string, std::string> metadata;
    for (const auto& [key, value] : json.items()) {
        if (!value.is_string())
            refuse(file, "metadata '" + key + "': expected a string, found " + value.type_name());
        metadata[key] = value.get<std::string>();
    }
    return metadata;
}

std::int64_t non_negative(const Json& json, const std::string& file, const std::string& what) {
    if (!json.is_number_unsigned() || json.get<std::uint64_t>() > std::uint64_t(INT64_MAX))
        refuse(file, what + ": expected a whole number from 0");
    return json.get<std::int64_t>();
}

// Beyond it numbers would be rounded to infinity.
constexpr float kLargestBf16 = 0x1.fep127F;

std::size_t bytes_of_number(const Tensor& tensor) {
    return tensor.bf16 ? sizeof(std::uint16_t) : sizeof(float);
}

/// Where a tensor lies in the data part.
struct Extent {
    std::string name;
    std::size_t begin = 0, end = 0;
};

Extent parse_extent(const std::string& name, const Json& entry, std::size_t data_size,
                    const std::string& file, Tensor& tensor) {
    const std::string what = "tensor '" + name + "'";
    if (!entry.is_object() || !entry.contains("dtype") || !entry.contains("shape") ||
        !entry.contains("data_offsets") || entry.size() != 3)
        refuse(file, what + ": expected dtype, shape and data_offsets, nothing else");
    tensor.bf16 = entry["dtype"] == "BF16";
    if (!tensor.bf16 && entry["dtype"] != "F32")
        refuse(file, what + ": expected dtype F32 or BF16, found " + entry["dtype"].dump());
    const Json& shape = entry["shape"];
    const Json& offsets = entry["data_offsets"];
    if (!shape.is_array() || shape.size() > kMaxDimensions)
        refuse(file, what + ": the shape is not a list of at most 8 numbers");
    for (const Json& n : shape) tensor.shape.push_back(non_negative(n, file, what + ": shape"));
    if (!offsets.is_array() || offsets.size() != 2)
        refuse(file, what + ": data_offsets is not a pair");
    const auto begin = std::size_t(non_negative(offsets[0], file, what + ": data_offsets"));
    const auto end = std::size_t(non_negative(offsets[1], file, what + ": data_offsets"));
    if (begin > end || end > data_size)
        refuse(file, what + ": expected data within " + std::to_string(data_size) +
                         " bytes, found " + std::to_string(begin) + " to " + std::to_string(end) +
                         " (the file is truncated or damaged)");
    std::size_t count = 0;
    try {
        count = element_count(tensor.shape);
    } catch (const Error& error) {
        refuse(file, what + ": " + error.what());
    }
    const std::size_t bytes = bytes_of_number(tensor);
    if ((end - begin) / bytes != count || (end - begin) % bytes != 0)
        refuse(file, what + ": shape " + shape_text(tensor.shape) + " takes " +
                         std::to_string(count) + " numbers of " + std::to_string(bytes) +
                         " bytes, found " + std::to_string(end - begin) + " bytes");
    return {name, begin, end};
}

void copy_values(std::span<const std::byte> data, const Extent& extent, const std::string& file,
                 Tensor& tensor) {
    tensor.values.resize((extent.end - extent.begin) / bytes_of_number(tensor));
    if (tensor.values.empty()) return;
    const std::byte* from = data.data() + extent.begin;
    if (tensor.bf16)
        for (float& value : tensor.values) {
            std::uint16_t half = 0;
            std::memcpy(&half, from, sizeof half);
            value = from_bf16(half);
            from += sizeof half;
        }
    else
        std::memcpy(tensor.values.data(), from, extent.end - extent.begin);
    for (std::size_t i = 0; i < tensor.values.size(); ++i)
        if (!std::isfinite(tensor.values[i]))
            refuse(file, "tensor '" + extent.name + "': number " + std::to_string(i) + " is " +
                             (std::isnan(tensor.values[i]) ? "NaN" : "infinite"));
}

/// Writes the numbers and returns where the next tensor's begin.
std::byte* store(const Tensor& tensor, std::byte* out) {
    if (tensor.values.empty()) return out;
    if (!tensor.bf16)
        std::memcpy(out, tensor.values.data(), tensor.values.size() * sizeof(float));
    else
        for (std::size_t i = 0; i < tensor.values.size(); ++i) {
            const std::uint16_t half =
                to_bf16(std::clamp(tensor.values[i], -kLargestBf16, kLargestBf16));
            std::memcpy(out + i * sizeof half, &half, sizeof half);
        }
    return out + tensor.values.size() * bytes_of_number(tensor);
}

/// The data must be covered once and wholly: a hole or an overlap is damage, or a hiding place.
void check_cover(std::vector<Extent> extents, std::size_t data_size, const std::string& file) {
    std::sort(extents.begin(), extents.end(), [](const Extent& a, const Extent& b) {
        return std::pair(a.begin, a.end) < std::pair(b.begin, b.end);
    });
    std::size_t at = 0;
    for (const Extent& extent : extents) {
        if (extent.begin != at)
            refuse(file, "tensor '" + extent.name + "': expected to begin at byte " +
                             std::to_string(at) + ", found " + std::to_string(extent.begin));
        at = extent.end;
    }
    if (at != data_size)
        refuse(file, "expected " + std::to_string(at) + " bytes of data, found " +
                         std::to_string(data_size));
}

}  // namespace

std::size_t element_count(std::span<const std::int64_t> shape) {
    std::size_t count = 1;
    for (const std::int64_t n : shape)
        if (n < 0 || __builtin_mul_overflow(count, std::size_t(n), &count))
            throw Error(ErrorKind::input, "shape " + shape_text(shape) + " is impossible");
    return count;
}

std::string shape_text(std::span<const std::int64_t> shape) {
    return "[" + list_of(shape, [](std::int64_t n) { return std::to_string(n); }) + "]";
}

TensorFile parse_safetensors(std::span<const std::byte> bytes, const std::string& name) {
    if (bytes.size() < kLengthBytes)
        refuse(name, "not a model or state (safetensors): only " + std::to_string(bytes.size()) +
                         " bytes");
    std::uint64_t header_size = 0;
    std::memcpy(&header_size, bytes.data(), kLengthBytes);
    if (header_size > kMaxHeaderBytes || header_size > bytes.size() - kLengthBytes)
        refuse(
            name,
            "not a model or state (safetensors), or truncated: expected a header that fits, found "
            "one of " +
                std::to_string(header_size) + " bytes in a file of " +
                std::to_string(bytes.size()));
    const auto text = bytes.subspan(kLengthBytes, std::size_t(header_size));
    const auto data = bytes.subspan(kLengthBytes + std::size_t(header_size));
    const Json header =
        parse_header({reinterpret_cast<const char*>(text.data()), text.size()}, name);

    TensorFile file;
    std::vector<Extent> extents;
    for (const auto& [key, entry] : header.items()) {
        if (key == "__metadata__") {
            file.metadata = parse_metadata(entry, name);
            continue;
        }
        extents.push_back(parse_extent(key, entry, data.size(), name, file.tensors[key]));
    }
    check_cover(extents, data.size(), name);
    for (const Extent& extent : extents) copy_values(data, extent, name, file.tensors[extent.name]);
    return file;
}

bool is_safetensors(const std::filesystem::path& path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return false;
    const auto size = std::filesystem::file_size(path, error);
    std::array<char, kLengthBytes + 1> begin{};
    std::ifstream file{path, std::ios::binary};
    if (error || !file.read(begin.data(), begin.size())) return false;
    std::uint64_t header_size = 0;
    std::memcpy(&header_size, begin.data(), kLengthBytes);
    return begin.back() == '{' && header_size <= size - kLengthBytes;
}

TensorFile read_safetensors(const std::filesystem::path& path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error))
        refuse(path.string(), error ? error.message() : "not a file");
    const auto size = std::filesystem::file_size(path, error);
    if (error) refuse(path.string(), "cannot be read: " + error.message());
    std::ifstream stream = open_to_read(path);
    std::vector<std::byte> bytes(size);
    stream.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(size));
    if (std::size_t(stream.gcount()) != bytes.size()) refuse(path.string(), "cannot be read");
    return parse_safetensors(bytes, path.string());
}

std::vector<std::byte> format_safetensors(const TensorFile& file) {
    Json header = Json::object();
    if (!file.metadata.empty()) header["__metadata__"] = file.metadata;
    std::size_t at = 0;
    for (const auto& [name, tensor] : file.tensors) {
        const std::size_t size = tensor.values.size() * bytes_of_number(tensor);
        header[name] = {{"dtype", tensor.bf16 ? "BF16" : "F32"},
                        {"shape", tensor.shape},
                        {"data_offsets", {at, at + size}}};
        at += size;
    }
    // Not-UTF-8 bytes in a card must not stop a training run from being saved.
    std::string text = header.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.append((8 - text.size() % 8) % 8, ' ');  // so that the numbers are aligned

    std::vector<std::byte> bytes(kLengthBytes + text.size() + at);
    const std::uint64_t header_size = text.size();
    std::memcpy(bytes.data(), &header_size, kLengthBytes);
    std::memcpy(bytes.data() + kLengthBytes, text.data(), text.size());
    std::byte* out = bytes.data() + kLengthBytes + text.size();
    for (const auto& [name, tensor] : file.tensors) {
        out = store(tensor, out);
    }
    return bytes;
}

void write_safetensors(const std::filesystem::path& path, const TensorFile& file, bool overwrite) {
    write_file(path, format_safetensors(file), overwrite);
}

}  // namespace eventide
