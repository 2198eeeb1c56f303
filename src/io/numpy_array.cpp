// "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 4), }", or descr as a list of fields.
#include "src/io/numpy_array.h"

#include "src/core/byte_order.h"
#include "src/core/error.h"
#include "src/core/list_text.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string_view>

namespace eventide {

namespace {

constexpr std::size_t kLongestHeader = std::size_t{1} << 16;
constexpr std::uint64_t kMaxItems = std::uint64_t{1} << 48;

/// A Python literal, from front to back.
class Literal {
public:
    explicit Literal(std::string_view text) : rest_(text) {}

    bool take(char wanted) {
        skip_spaces();
        if (!rest_.starts_with(wanted)) return false;
        rest_.remove_prefix(1);
        return true;
    }
    bool text(std::string& into) {
        skip_spaces();
        if (rest_.empty() || (rest_[0] != '\'' && rest_[0] != '"')) return false;
        const std::size_t end = rest_.find(rest_[0], 1);
        if (end == rest_.npos) return false;
        into = rest_.substr(1, end - 1);
        rest_.remove_prefix(end + 1);
        return true;
    }
    bool whole(std::uint64_t& into) {
        skip_spaces();
        std::size_t n = 0;
        for (into = 0; n < rest_.size() && rest_[n] >= '0' && rest_[n] <= '9' && n < 15; ++n)
            into = into * 10 + std::uint64_t(rest_[n] - '0');
        rest_.remove_prefix(n);
        if (rest_.starts_with('L')) rest_.remove_prefix(1);  // Python 2
        return n > 0;
    }
    bool word(std::string_view wanted) {
        skip_spaces();
        if (!rest_.starts_with(wanted)) return false;
        rest_.remove_prefix(wanted.size());
        return true;
    }

private:
    void skip_spaces() {
        rest_.remove_prefix(std::min(rest_.find_first_not_of(" \n"), rest_.size()));
    }
    std::string_view rest_;
};

/// "<f8"; of texts and padding only the length counts.
bool parse_kind(const std::string& text, NumpyField& field) {
    if (text.size() < 3 || (text[0] == '>' && text.substr(2) != "1")) return false;
    field.kind = text[1];
    field.bytes = 0;
    for (const char c : text.substr(2)) {
        if (c < '0' || c > '9' || field.bytes > 1'000'000) return false;
        field.bytes = field.bytes * 10 + std::uint64_t(c - '0');
    }
    if (field.kind == 'U') field.bytes *= 4;
    return field.kind != 'O' && field.bytes > 0;
}

bool parse_fields(Literal& literal, NumpyArray& array) {
    std::string kind;
    NumpyField field;
    if (literal.text(kind)) {
        array.record_bytes = parse_kind(kind, field) ? field.bytes : 0;
        array.fields = {field};
        return array.record_bytes > 0;
    }
    if (!literal.take('[')) return false;
    while (!literal.take(']')) {
        if (!literal.take('(') || !literal.text(field.name) || !literal.take(',') ||
            !literal.text(kind) || !parse_kind(kind, field) || !literal.take(')'))
            return false;
        field.offset = array.record_bytes;
        array.record_bytes += field.bytes;
        if (!field.name.empty()) array.fields.push_back(field);
        literal.take(',');
    }
    return !array.fields.empty();
}

bool parse_shape(Literal& literal, NumpyArray& array) {
    if (!literal.take('(')) return false;
    while (!literal.take(')')) {
        std::uint64_t side = 0;
        if (!literal.whole(side) || array.shape.size() == 8) return false;
        array.shape.push_back(side);
        literal.take(',');
    }
    return true;
}

bool parse(std::string_view text, NumpyArray& array) {
    Literal literal(text);
    if (!literal.take('{')) return false;
    for (std::string key; literal.text(key);) {
        if (!literal.take(':')) return false;
        if (key == "fortran_order") {
            array.columns_first = literal.word("True");
            if (!array.columns_first && !literal.word("False")) return false;
        } else if (key == "descr") {
            if (!parse_fields(literal, array)) return false;
        } else if (key != "shape" || !parse_shape(literal, array)) {
            return false;
        }
        literal.take(',');
    }
    return literal.take('}') && array.record_bytes > 0;
}

/// To the whole rows in so many bytes. False where the rows are not one behind the other, or none.
bool cut_to(std::uint64_t bytes, NumpyArray& array) {
    const bool in_rows =
        array.shape.size() == 1 || (array.shape.size() == 2 && array.shape[1] == 4);
    if (!in_rows || array.columns_first) return false;
    const std::uint64_t row = array.record_bytes * (array.shape.size() == 2 ? 4 : 1);
    array.shape[0] = bytes / row;
    array.is_cut = true;
    return array.shape[0] > 0;
}

}  // namespace

bool NumpyField::is_number() const {
    if (kind == 'f') return bytes == 4 || bytes == 8;
    return (kind == 'i' || kind == 'u' || kind == 'b') &&
           (bytes == 1 || bytes == 2 || bytes == 4 || bytes == 8);
}

bool NumpyArray::is_of_numbers_in_rows() const {
    return !is_of_records() && fields.front().is_number() && (!columns_first || shape.size() < 2);
}

std::uint64_t NumpyArray::items() const {
    std::uint64_t items = 1;
    for (const std::uint64_t side : shape) items *= side;
    return items;
}

std::string NumpyArray::shape_text() const {
    return "(" + list_of(shape, [](std::uint64_t side) { return std::to_string(side); }) + ")";
}

const NumpyField* NumpyArray::field(const std::string& name) const {
    const auto found = std::ranges::find(fields, name, &NumpyField::name);
    return found == fields.end() ? nullptr : &*found;
}

NumpyArray read_numpy_header(ByteSource& bytes, const std::string& name, CutArrays cut) {
    const auto refuse = [&](const std::string& what) {
        throw Error(ErrorKind::input, name + ": expected a NumPy array, found " + what);
    };
    std::vector<std::byte> begin(std::size_t(std::min<std::uint64_t>(bytes.size(), 12)));
    const std::string_view magic = "\x93NUMPY";
    if (begin.size() < 12 || !bytes.read_at(0, begin) ||
        !std::equal(magic.begin(), magic.end(), begin.begin(),
                    [](char a, std::byte b) { return std::byte(a) == b; }))
        refuse("something else");
    const bool large = std::to_integer<int>(begin[6]) >= 2;
    const std::size_t start = large ? 12 : 10;
    const std::size_t length = large ? load_little<std::uint32_t>(begin.data() + 8)
                                     : load_little<std::uint16_t>(begin.data() + 8);
    if (length > kLongestHeader || length > bytes.size() - start) refuse("a header cut short");
    std::string text(length, '\0');
    NumpyArray array;
    if (!bytes.read_at(start, std::as_writable_bytes(std::span(text))) || !parse(text, array))
        refuse("a header that is not supported: " + text.substr(0, 80));
    array.data_offset = start + length;
    std::uint64_t items = 1;
    for (const std::uint64_t side : array.shape) {
        if (side != 0 && items > kMaxItems / side) refuse("a shape too large");
        items *= side;
    }
    const std::uint64_t held = bytes.size() - array.data_offset;
    const std::string shape = array.shape_text();
    if (array.record_bytes > kLongestHeader ||
        (items > held / array.record_bytes && !(cut == CutArrays::read && cut_to(held, array))))
        refuse("a shape " + shape + " that its " + std::to_string(bytes.size()) +
               " bytes do not hold");
    return array;
}

double numpy_number(const NumpyField& field, const std::byte* at) {
    if (field.kind == 'f')
        return field.bytes == 4 ? double(load_little_float(at))
                                : std::bit_cast<double>(load_little<std::uint64_t>(at));
    if (field.kind == 'u' && field.bytes == 8) return double(load_little<std::uint64_t>(at));
    return double(numpy_integer(field, at));
}

std::int64_t numpy_integer(const NumpyField& field, const std::byte* at) {
    constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
    const bool is_signed = field.kind == 'i';
    switch (field.kind == 'f' ? 0 : field.bytes) {
        case 1:
            return is_signed ? load_little<std::int8_t>(at) : load_little<std::uint8_t>(at);
        case 2:
            return is_signed ? std::int16_t(load_little<std::uint16_t>(at))
                             : load_little<std::uint16_t>(at);
        case 4:
            return is_signed ? std::int32_t(load_little<std::uint32_t>(at))
                             : std::int64_t{load_little<std::uint32_t>(at)};
        case 8: {
            const auto value = load_little<std::uint64_t>(at);
            return !is_signed && value > std::uint64_t(kMax) ? kMax : std::int64_t(value);
        }
        default: {
            const double value = numpy_number(field, at);
            return std::abs(value) < 9e18 ? std::int64_t(value)
                                          : std::numeric_limits<std::int64_t>::min();
        }
    }
}

}  // namespace eventide
