// NumPy files as recordings.
#include "replay/numpy/numpy_recording.h"

#include "replay/numpy/file_bytes.h"
#include "replay/numpy/numpy_layouts.h"
#include "replay/numpy/numpy_table.h"
#include "replay/table_reader.h"
#include "src/codec/text/text_layout.h"
#include "src/core/error.h"
#include "src/core/list_text.h"
#include "src/io/zip_directory.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>
#include <utility>

namespace eventide {

namespace {

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

ZipArchive archive_in(const ByteFile& file) {
    return {file.path(), file.size(), [&file](std::uint64_t offset, std::span<std::byte> into) {
                return file.read_at(offset, into);
            }};
}

std::vector<NamedNumpyArray> arrays_of(const ByteFile& file) {
    std::vector<NamedNumpyArray> arrays;
    for (const ZipEntry& entry : read_zip_directory(archive_in(file))) {
        if (!entry.name.ends_with(".npy")) continue;
        NamedNumpyArray named{entry.name.substr(0, entry.name.size() - 4), nullptr, {}};
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

}  // namespace

std::unique_ptr<DataReader> open_npy(const std::string& path, const OpenOptions& options) {
    auto file = std::make_unique<ByteFile>(path);
    const auto source = std::make_shared<StoredBytes>(*file, 0, file->size());
    const NumpyArray array = read_numpy_header(*source, path, CutArrays::read);
    NumpyEvents found;
    if (find_numpy_rows({path, source, array}, found))
        return make_reader(std::move(file), std::move(found), "npy", options);
    throw Error(ErrorKind::input,
                path + ": expected records with t, x, y and p, or rows of four numbers, found " +
                    (array.is_of_records() ? "other records" : "numbers") + " of shape " +
                    array.shape_text());
}

std::unique_ptr<DataReader> open_npz(const std::string& path, const OpenOptions& options) {
    auto file = std::make_unique<ByteFile>(path);
    const std::vector<NamedNumpyArray> arrays = arrays_of(*file);
    NumpyEvents found;
    if (find_numpy_columns(path, arrays, found))
        return make_reader(std::move(file), std::move(found), "npz", options);
    for (const NamedNumpyArray& each : arrays)
        if (find_numpy_rows({path + ": " + each.name, each.source, each.array}, found))
            return make_reader(std::move(file), std::move(found), "npz", options);
    if (const std::string text = only_text(*file); !text.empty())
        throw Error(ErrorKind::input, path + ": expected an archive of NumPy arrays, found " +
                                          text + "; unzip -p FILE " + text +
                                          " | eventide run - reads it");
    const std::string names = list_of(arrays, [](const NamedNumpyArray& each) {
        return each.name + " " + each.array.shape_text();
    });
    throw Error(ErrorKind::input,
                path +
                    ": expected arrays t, x, y and p, or one of records with these, or of four "
                    "numbers a row, found " +
                    (names.empty() ? "no arrays" : names));
}

}  // namespace eventide
