// Which array is what.
#include "replay/numpy/numpy_layouts.h"

#include "src/core/error.h"
#include "src/core/lower_case.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace eventide {

namespace {

constexpr std::array<std::string_view, 4> kFields{"t", "x", "y", "p"};  // as TextField

/// What a column may be called, besides what header rows of text are.
std::string canonical(std::string_view column) {
    std::string name = lower_case(column);
    if (name == "xs") return "x";
    if (name == "ys") return "y";
    if (name == "ps" || name == "pol" || name == "polarity" || name == "polarities" || name == "on")
        return "p";
    return name;
}

/// A time, with its unit in the name or without: "t", "ts", "timestamp_us".
bool names_time(const std::string& name) {
    const std::string stem = name.substr(0, name.find('_'));
    return stem == "t" || stem == "ts" || stem == "time" || stem == "timestamp" ||
           stem == "timestamps";
}

/// 0 to 3 as TextField; -1 for others.
int field_of(const std::string& name) {
    const std::string known = canonical(name);
    if (names_time(known)) return 0;
    const auto found = std::ranges::find(kFields, known);
    return found == kFields.end() ? -1 : int(found - kFields.begin());
}

void check_number(const NumpyField& field, const std::string& what) {
    if (!field.is_number())
        throw Error(ErrorKind::input, what + ": expected numbers, found an array of kind '" +
                                          std::string(1, field.kind) + std::to_string(field.bytes) +
                                          "'");
}

/// The records of Metavision's arrays, whose times are microseconds: {x, y, p, t}.
bool is_event_cd(const NumpyArray& array) {
    constexpr std::array<std::pair<std::string_view, char>, 4> kEventCd{
        {{"x", 'u'}, {"y", 'u'}, {"p", 'i'}, {"t", 'i'}}};
    constexpr auto kIs = [](const NumpyField& field, const auto& known) {
        return field.name == known.first && field.kind == known.second &&
               field.bytes == (known.first == "t" ? 8 : 2);
    };
    return std::ranges::equal(array.fields, kEventCd, kIs);
}

/// Records with the four fields. False where they have others.
bool find_records(const NamedNumpyArray& named, NumpyEvents& found) {
    const auto& [name, source, array] = named;
    if (!array.is_of_records() || array.shape.size() != 1) return false;
    std::array<bool, 4> seen{};
    for (const NumpyField& field : array.fields) {
        const int which = field_of(field.name);
        if (which < 0 || std::exchange(seen[std::size_t(which)], true)) continue;
        check_number(field, name + ": " + field.name);
        found.columns.push_back({0, field, which == 0 ? field.name : canonical(field.name)});
    }
    if (found.columns.size() != 4) return false;
    if (is_event_cd(array)) found.columns.back().name = "t_us";
    found.rows = {{source, array.data_offset, array.record_bytes}};
    found.count = array.rows();
    found.is_cut = array.is_cut;
    return true;
}

/// [event][4]; columns first and [4][event] are four arrays, one behind the other.
bool find_matrix(const NamedNumpyArray& named, NumpyEvents& found) {
    const auto& [name, source, array] = named;
    if (array.is_of_records() || array.shape.size() != 2) return false;
    const bool across = array.shape[1] != 4 && array.shape[0] == 4;
    if (array.shape[1] != 4 && !across) return false;
    const bool behind = across != array.columns_first;
    if (behind && source->is_sequential())
        throw Error(ErrorKind::input,
                    name +
                        ": expected rows of t x y p, found a packed array with its columns "
                        "behind each other; numpy.savez, or an array in C order, is read");
    check_number(array.fields.front(), name);
    found.count = array.shape[across ? 1 : 0];
    const std::uint64_t item = array.record_bytes;
    if (!behind) found.rows = {{source, array.data_offset, 4 * item}};
    for (std::uint64_t i = 0; i < 4; ++i) {
        NumpyField field = array.fields.front();
        if (behind)
            found.rows.push_back({source, array.data_offset + i * found.count * item, item});
        else
            field.offset = i * item;
        found.columns.push_back({behind ? std::size_t(i) : 0, field, ""});
    }
    found.named = false;
    found.is_cut = array.is_cut;
    return true;
}

}  // namespace

bool find_numpy_rows(const NamedNumpyArray& named, NumpyEvents& found) {
    return find_records(named, found = {}) || find_matrix(named, found = {});
}

bool find_numpy_columns(const std::string& file, const std::vector<NamedNumpyArray>& arrays,
                        NumpyEvents& found) {
    std::array<bool, 4> seen{};
    for (const NamedNumpyArray& each : arrays) {
        const int which = field_of(each.name);
        if (which < 0 || each.array.shape.size() != 1 || each.array.is_of_records()) continue;
        if (std::exchange(seen[std::size_t(which)], true)) continue;
        check_number(each.array.fields.front(), file + ": " + each.name);
        if (!found.rows.empty() && each.array.rows() != found.count)
            throw Error(ErrorKind::input,
                        file + ": " + each.name + ": expected as many numbers as " +
                            found.columns.front().name + ", " + std::to_string(found.count) +
                            ", found " + std::to_string(each.array.rows()));
        found.count = each.array.rows();
        found.columns.push_back({found.rows.size(), each.array.fields.front(),
                                 which == 0 ? each.name : canonical(each.name)});
        found.rows.push_back({each.source, each.array.data_offset, each.array.record_bytes});
    }
    return found.columns.size() == 4;
}

}  // namespace eventide
