// Which array is what, and its rows as events.
#include "replay/numpy/numpy_recording.h"

#include "replay/numpy/file_bytes.h"
#include "replay/numpy/numpy_table.h"
#include "replay/table_reader.h"
#include "src/codec/text/text_layout.h"
#include "src/core/error.h"
#include "src/core/list_text.h"
#include "src/core/lower_case.h"
#include "src/io/zip_directory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>
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

/// The file stays open for the arrays in it.
class NumpyReader final : public DataReader {
public:
    /// `is_cut`: the file ends inside a row.
    NumpyReader(std::unique_ptr<ByteFile> file, std::unique_ptr<TableReader> table,
                std::vector<std::string> remarks, bool is_cut)
        : file_(std::move(file)),
          table_(std::move(table)),
          remarks_(std::move(remarks)),
          is_cut_(is_cut) {
        std::ranges::copy(table_->remarks(), std::back_inserter(remarks_));
    }
    const StreamHeader& header() const override { return table_->header(); }
    bool read(Batch& into, Damage& damage) override {
        const bool goes_on = table_->read(into, damage);
        if (!goes_on && std::exchange(is_cut_, false)) damage.count(DamageReason::truncated);
        return goes_on;
    }
    void seek(SensorTime t) override { table_->seek(t); }
    double progress() const override { return table_->progress(); }
    std::vector<std::string> remarks() const override { return remarks_; }

private:
    std::unique_ptr<ByteFile> file_;
    std::unique_ptr<TableReader> table_;
    std::vector<std::string> remarks_;
    bool is_cut_;  ///< and it is not counted yet
};

/// The beginning as a text would have it, for the same rules on columns and units.
std::string as_text(NumpyEvents& found, const std::string& path) {
    constexpr std::uint64_t kRowsToShow = 2000;
    std::string text;
    if (found.named) {
        for (const NumpyColumn& column : found.columns) text += column.name + " ";
        text += "\n";
    }
    const auto count = std::size_t(std::min(found.count, kRowsToShow));
    for (NumpyRows& rows : found.rows)
        if (!rows.read(0, count))
            throw Error(ErrorKind::input, path + ": expected " + std::to_string(found.count) +
                                              " rows, found none that can be read");
    for (std::size_t i = 0; i < count; ++i) {
        for (const NumpyColumn& column : found.columns) {
            const NumpyRows& rows = found.rows[column.rows];
            const std::byte* at = rows.block.data() + i * rows.stride + column.field.offset;
            const double value = numpy_number(column.field, at);
            char number[48];
            const bool whole = column.field.kind != 'f' || value == std::floor(value);
            if (column.field.kind != 'f')
                std::snprintf(number, sizeof number, "%lld ",
                              static_cast<long long>(numpy_integer(column.field, at)));
            else
                std::snprintf(number, sizeof number, whole ? "%.0f " : "%.9f ", value);
            text += number;
        }
        text += "\n";
    }
    return text;
}

std::unique_ptr<DataReader> make_reader(std::unique_ptr<ByteFile> file, NumpyEvents found,
                                        const char* format, const OpenOptions& options) {
    const std::string path = file->path();
    TextHeader text;
    if (found.count > 0) {
        const std::string rows = as_text(found, path);
        try {
            TextOptions stated = options.text;
            if (found.named) stated.columns.clear();
            stated.reorder = {};  // arrays are not sorted
            text = read_text_header(std::as_bytes(std::span(rows)), stated);
        } catch (const Error& error) {
            throw Error(error.kind(), path + ": read as rows: " + error.what());
        }
    }
    StreamHeader header;
    header.format = format;
    const bool is_cut = found.is_cut;
    auto table = std::make_unique<TableReader>(
        path, header, make_numpy_table(std::move(found), text.layout), nullptr, options);
    return std::make_unique<NumpyReader>(std::move(file), std::move(table), std::move(text.remarks),
                                         is_cut);
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
bool find_records(const std::shared_ptr<ByteSource>& source, const NumpyArray& array,
                  const std::string& name, NumpyEvents& found) {
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
bool find_matrix(const std::shared_ptr<ByteSource>& source, const NumpyArray& array,
                 const std::string& name, NumpyEvents& found) {
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

struct NamedArray {
    std::string name;
    std::shared_ptr<ByteSource> source;
    NumpyArray array;
};

ZipArchive archive_in(const ByteFile& file) {
    return {file.path(), file.size(), [&file](std::uint64_t offset, std::span<std::byte> into) {
                return file.read_at(offset, into);
            }};
}

std::vector<NamedArray> arrays_of(const ByteFile& file) {
    std::vector<NamedArray> arrays;
    for (const ZipEntry& entry : read_zip_directory(archive_in(file))) {
        if (!entry.name.ends_with(".npy")) continue;
        NamedArray named{entry.name.substr(0, entry.name.size() - 4), nullptr, {}};
        if (entry.method == 0)
            named.source = std::make_shared<StoredBytes>(file, entry.begin, entry.packed_size);
        else if (entry.method == 8)
            named.source =
                std::make_shared<DeflatedBytes>(file, entry.begin, entry.packed_size, entry.size);
        else
            continue;
        try {
            named.array = read_numpy_header(*named.source, file.path() + ": " + named.name);
        } catch (const Error&) {  // of texts or objects: somebody else's
            continue;
        }
        arrays.push_back(std::move(named));
    }
    return arrays;
}

/// The first text recording, by its name, of an archive without arrays; empty where there is none.
std::string only_text(const ByteFile& file) {
    std::string first;
    for (const ZipEntry& entry : read_zip_directory(archive_in(file))) {
        if (entry.name.ends_with(".npy")) return {};
        const bool is_text = entry.name.ends_with(".txt") || entry.name.ends_with(".csv");
        // The name is part of a command that people copy.
        const bool is_plain = std::ranges::all_of(entry.name, [](char c) {
            return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                   c == '.' || c == '_' || c == '-' || c == '/';
        });
        if (first.empty() && is_text && is_plain && !entry.name.starts_with('-'))
            first = entry.name;
    }
    return first;
}

/// An array for each column.
bool find_columns(const ByteFile& file, const std::vector<NamedArray>& arrays, NumpyEvents& found) {
    std::array<bool, 4> seen{};
    for (const NamedArray& each : arrays) {
        const int which = field_of(each.name);
        if (which < 0 || each.array.shape.size() != 1 || each.array.is_of_records()) continue;
        if (std::exchange(seen[std::size_t(which)], true)) continue;
        check_number(each.array.fields.front(), file.path() + ": " + each.name);
        if (!found.rows.empty() && each.array.rows() != found.count)
            throw Error(ErrorKind::input,
                        file.path() + ": " + each.name + ": expected as many numbers as " +
                            found.columns.front().name + ", " + std::to_string(found.count) +
                            ", found " + std::to_string(each.array.rows()));
        found.count = each.array.rows();
        found.columns.push_back({found.rows.size(), each.array.fields.front(),
                                 which == 0 ? each.name : canonical(each.name)});
        found.rows.push_back({each.source, each.array.data_offset, each.array.record_bytes});
    }
    return found.columns.size() == 4;
}

}  // namespace

std::unique_ptr<DataReader> open_npy(const std::string& path, const OpenOptions& options) {
    auto file = std::make_unique<ByteFile>(path);
    const auto source = std::make_shared<StoredBytes>(*file, 0, file->size());
    const NumpyArray array = read_numpy_header(*source, path, CutArrays::read);
    NumpyEvents found;
    if (find_records(source, array, path, found) ||
        find_matrix(source, array, path, found = NumpyEvents{}))
        return make_reader(std::move(file), std::move(found), "npy", options);
    throw Error(ErrorKind::input,
                path + ": expected records with t, x, y and p, or rows of four numbers, found " +
                    (array.is_of_records() ? "other records" : "numbers") + " of shape " +
                    array.shape_text());
}

std::unique_ptr<DataReader> open_npz(const std::string& path, const OpenOptions& options) {
    auto file = std::make_unique<ByteFile>(path);
    const std::vector<NamedArray> arrays = arrays_of(*file);
    NumpyEvents found;
    if (find_columns(*file, arrays, found))
        return make_reader(std::move(file), std::move(found), "npz", options);
    for (const NamedArray& each : arrays) {
        const std::string name = path + ": " + each.name;
        if (find_records(each.source, each.array, name, found = NumpyEvents{}) ||
            find_matrix(each.source, each.array, name, found = NumpyEvents{}))
            return make_reader(std::move(file), std::move(found), "npz", options);
    }
    if (const std::string text = only_text(*file); !text.empty())
        throw Error(ErrorKind::input, path + ": expected an archive of NumPy arrays, found " +
                                          text + "; unzip -p FILE " + text +
                                          " | eventide run - reads it");
    const std::string names = list_of(
        arrays, [](const NamedArray& each) { return each.name + " " + each.array.shape_text(); });
    throw Error(ErrorKind::input,
                path +
                    ": expected arrays t, x, y and p, or one of records with these, or of four "
                    "numbers a row, found " +
                    (names.empty() ? "no arrays" : names));
}

}  // namespace eventide
