// NumPy's format 1.0 to 3.0 (numpy.lib.format).
#include "src/io/npy.h"

#include "src/core/error.h"

#include <array>
#include <bit>
#include <cstring>
#include <string_view>

namespace eventide {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are read in place");

constexpr std::uint64_t kMaxNumbers = std::uint64_t{1} << 40;

template <typename T>
T number_at(const std::byte* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

/// What follows `key` in the header, a Python dictionary as text.
std::string_view value_after(std::string_view header, std::string_view key) {
    const auto at = header.find(key);
    if (at == header.npos) return {};
    const auto start = header.find_first_not_of(": ", at + key.size());
    return start == header.npos ? std::string_view{} : header.substr(start);
}

/// "(64, 3, 3, 3), ..." -> {64, 3, 3, 3}; false where it is not such a tuple.
bool parse_shape(std::string_view text, std::vector<std::int64_t>& shape) {
    if (!text.starts_with('(')) return false;
    text.remove_prefix(1);
    while (!text.empty() && text.front() != ')') {
        if (text.front() == ' ' || text.front() == ',') {
            text.remove_prefix(1);
            continue;
        }
        std::int64_t value = 0;
        std::size_t digits = 0;
        for (; digits < text.size() && text[digits] >= '0' && text[digits] <= '9' && digits < 13;
             ++digits)
            value = value * 10 + (text[digits] - '0');
        if (digits == 0 || digits > 12 || shape.size() == 8) return false;
        shape.push_back(value);
        text.remove_prefix(digits);
    }
    return !text.empty();
}

/// "'<f4'" and the like; false for what is not read.
bool parse_kind(std::string_view text, NpyHeader& header) {
    if (text.size() < 5 || text[0] != '\'' || text[4] != '\'') return false;
    if (text[1] != '<' && text[1] != '|') return false;
    header.kind = text[2];
    header.item_bytes = text[3] - '0';
    const bool size_known = header.item_bytes == 1 || header.item_bytes == 2 ||
                            header.item_bytes == 4 || header.item_bytes == 8;
    switch (header.kind) {
        case 'f':
            return header.item_bytes == 4 || header.item_bytes == 8;
        case 'i':
        case 'u':
            return size_known;
        case 'b':
            return header.item_bytes == 1;
        default:
            return false;
    }
}

}  // namespace

NpyHeader parse_npy_header(std::span<const std::byte> begin, const std::string& name) {
    const auto refuse = [&](const std::string& what) {
        throw Error(ErrorKind::input, name + ": " + what + " (expected a NumPy array)");
    };
    const std::string_view text{reinterpret_cast<const char*>(begin.data()), begin.size()};
    if (text.size() < 12 || !text.starts_with("\x93NUMPY")) refuse("no .npy file");
    const bool long_header = text[6] >= 2;
    const std::size_t start = long_header ? 12 : 10;
    const std::size_t length = long_header ? number_at<std::uint32_t>(begin.data() + 8)
                                           : number_at<std::uint16_t>(begin.data() + 8);
    if (length > text.size() - start) refuse("a header cut short");
    const std::string_view dictionary = text.substr(start, length);
    NpyHeader header;
    const std::string_view kind = value_after(dictionary, "'descr'");
    if (!parse_kind(kind, header))
        refuse("numbers of kind " + std::string{kind.substr(0, 8)} + ", which are not supported");
    if (!value_after(dictionary, "'fortran_order'").starts_with("False")) refuse("Fortran order");
    if (!parse_shape(value_after(dictionary, "'shape'"), header.shape))
        refuse("a shape that cannot be read");
    for (const std::int64_t n : header.shape) {
        if (n != 0 && header.count > kMaxNumbers / std::uint64_t(n)) refuse("a shape too large");
        header.count *= std::uint64_t(n);
    }
    header.data_offset = start + length;
    return header;
}

double npy_number(const NpyHeader& header, const std::byte* data, std::size_t i) {
    const std::byte* at = data + i * std::size_t(header.item_bytes);
    const bool is_signed = header.kind == 'i';
    if (header.kind == 'f')
        return header.item_bytes == 4 ? double(number_at<float>(at)) : number_at<double>(at);
    switch (header.item_bytes) {
        case 1:
            return is_signed ? number_at<std::int8_t>(at) : number_at<std::uint8_t>(at);
        case 2:
            return is_signed ? number_at<std::int16_t>(at) : number_at<std::uint16_t>(at);
        case 4:
            return is_signed ? number_at<std::int32_t>(at) : number_at<std::uint32_t>(at);
        default:
            return is_signed ? double(number_at<std::int64_t>(at))
                             : double(number_at<std::uint64_t>(at));
    }
}

NpyFile::NpyFile(const std::filesystem::path& path)
    : name_(path.string()), file_(path, std::ios::binary) {
    if (!file_) throw Error(ErrorKind::input, name_ + ": cannot be opened");
    std::array<std::byte, 4096> begin{};  // headers are one line of text
    file_.read(reinterpret_cast<char*>(begin.data()), std::streamsize(begin.size()));
    header_ = parse_npy_header(std::span{begin}.first(std::size_t(file_.gcount())), name_);
    const std::uint64_t need =
        header_.data_offset + header_.count * std::uint64_t(header_.item_bytes);
    if (std::filesystem::file_size(path) < need)
        throw Error(ErrorKind::input, name_ + ": expected " + std::to_string(need) +
                                          " bytes, found " +
                                          std::to_string(std::filesystem::file_size(path)));
}

std::uint64_t NpyFile::rows() const {
    return header_.shape.empty() ? 0 : std::uint64_t(header_.shape[0]);
}

std::uint64_t NpyFile::row_length() const {
    const std::uint64_t rows_there = rows();
    return rows_there == 0 ? 0 : header_.count / rows_there;
}

std::vector<double> NpyFile::read(std::uint64_t first_row, std::uint64_t count) {
    if (first_row > rows() || count > rows() - first_row)
        throw Error(ErrorKind::input,
                    name_ + ": expected more than " + std::to_string(rows()) + " rows");
    const std::uint64_t item = std::uint64_t(header_.item_bytes), numbers = count * row_length();
    std::vector<std::byte> bytes(std::size_t(numbers * item));
    file_.clear();
    file_.seekg(std::streamoff(header_.data_offset + first_row * row_length() * item));
    file_.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(bytes.size()));
    if (std::size_t(file_.gcount()) != bytes.size())
        throw Error(ErrorKind::input, name_ + ": ends before its last number");
    std::vector<double> out(static_cast<std::size_t>(numbers));
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = npy_number(header_, bytes.data(), i);
    return out;
}

}  // namespace eventide
