// Images of an Event Camera Dataset folder, merged with its events by time.
#include "replay/ecd_folder.h"

#include "replay/image_file.h"
#include "src/codec/text/text_number.h"
#include "src/codec/text/text_row.h"
#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/core/text_piece.h"
#include "src/core/whole_sensor.h"
#include "src/io/input_file.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <utility>

namespace eventide {

namespace fs = std::filesystem;

std::optional<std::string> find_ecd_folder(const std::string& path) {
    std::error_code ignored;
    const fs::path given(path);
    if (fs::is_directory(given, ignored)) {
        if (fs::is_regular_file(given / "events.txt", ignored)) return path;
        return {};
    }
    const fs::path folder = given.parent_path();
    if (given.filename() == "events.txt" && fs::is_regular_file(folder / "images.txt", ignored))
        return folder.empty() ? "." : folder.string();
    return {};
}

namespace {

std::optional<SensorTime> parse_seconds(std::string_view text) {
    const auto value = parse_decimal(text);
    const auto us = value ? scaled_integer(*value, 6) : std::nullopt;
    return us ? std::optional(from_us(*us)) : std::nullopt;
}

/// Fields of the lines that are no comments.
std::vector<std::vector<std::string>> read_table(const fs::path& path) {
    std::vector<std::vector<std::string>> table;
    std::error_code none;
    if (!fs::exists(path, none)) return table;
    if (!fs::is_regular_file(path, none))
        throw Error(ErrorKind::input, path.string() + ": expected a file, found something else");
    std::ifstream file = open_to_read(path);
    for (std::string line; std::getline(file, line);) {
        if (is_comment(line)) continue;
        const auto fields = split_fields(line);
        table.emplace_back(fields.begin(), fields.end());
    }
    return table;
}

/// The image that a line names, without detours; nothing where that lies outside the folder: a
/// recording from elsewhere must not reach for other files.
std::optional<std::string> inside(const fs::path& folder, const std::string& name) {
    const fs::path root = fs::absolute(folder).lexically_normal();
    const fs::path file = (root / name).lexically_normal();
    const fs::path way = file.lexically_relative(root);
    if (way.empty() || *way.begin() == "..") return {};
    return (folder / way).string();
}

/// Only where they are as many as the images: else there is no telling whose they are.
void set_exposures(const fs::path& path, EcdImages& images) {
    const auto table = read_table(path);
    if (table.size() != images.entries.size() || images.bad_entries > 0) return;
    for (std::size_t i = 0; i < table.size(); ++i) {
        if (table[i].size() < 2) continue;
        const auto begin = parse_seconds(table[i][0]), end = parse_seconds(table[i][1]);
        if (!begin || !end || *end < *begin) continue;
        images.entries[i].exposure_begin = *begin;
        images.entries[i].exposure_end = *end;
    }
}

std::string joined(const std::vector<std::string>& fields) {
    std::string line;
    for (const std::string& field : fields) line += (line.empty() ? "" : " ") + field;
    return line;
}

/// Of what is left out, one example for all.
void remark(EcdImages& images, const std::string& first_bad_line) {
    if (images.bad_entries > 0)
        images.remarks.push_back(
            "images.txt: expected a time in seconds and a file in the folder, found \"" +
            piece_of(first_bad_line) + "\"; " + std::to_string(images.bad_entries) +
            " such lines are left out");
    std::size_t missing = 0;
    std::string first;
    std::error_code none;
    for (const auto& entry : images.entries)
        if (!fs::is_regular_file(entry.path, none) && ++missing == 1) first = entry.path;
    if (missing > 0)
        images.remarks.push_back("images.txt: expected " + piece_of(first) +
                                 ", found no such file; " + std::to_string(missing) + " of " +
                                 std::to_string(images.entries.size()) + " images are not there");
}

}  // namespace

EcdImages read_ecd_images(const std::string& folder) {
    EcdImages images;
    std::string first_bad_line;
    for (const auto& fields : read_table(fs::path(folder) / "images.txt")) {
        const auto t = fields.size() < 2 ? std::nullopt : parse_seconds(fields[0]);
        const auto file = t ? inside(folder, fields[1]) : std::nullopt;
        if (file)
            images.entries.push_back({*t, *t, *t, *file});
        else if (++images.bad_entries == 1)
            first_bad_line = joined(fields);
    }
    set_exposures(fs::path(folder) / "exposure.txt", images);
    std::stable_sort(images.entries.begin(), images.entries.end(),
                     [](const auto& a, const auto& b) { return a.t < b.t; });
    remark(images, first_bad_line);
    for (const auto& entry : images.entries)
        if (const auto size = size_of_image_file(entry.path)) {
            images.width = size->width;
            images.height = size->height;
            break;
        }
    return images;
}

EcdParser::EcdParser(std::unique_ptr<Parser> events, EcdImages images, int width, int height,
                     bool in_the_middle)
    : events_(std::move(events)),
      images_(std::move(images)),
      width_(width),
      height_(height),
      jumped_(in_the_middle) {
    image_damage_.count(DamageReason::bad_record, images_.bad_entries);
}

/// Each among the events from number `first` on as its time says. Empty: all that are left.
void EcdParser::emit_until(std::optional<SensorTime> t, std::size_t first, Batch& into) {
    for (; next_image_ < images_.entries.size(); ++next_image_) {
        const auto& entry = images_.entries[next_image_];
        if (t && entry.t > *t) break;
        std::optional<ReferenceImage> image = read_image_file(entry.path);
        // An image of another size is another camera's: nothing says where its pixels lie.
        if (!image || !covers_sensor(*image, width_, height_)) {
            image_damage_.count(DamageReason::bad_record);
            continue;
        }
        image->t = entry.t;
        image->exposure_begin = entry.exposure_begin;
        image->exposure_end = entry.exposure_end;
        into.add_image(std::move(*image));
        const auto next =
            std::find_if(into.events.begin() + std::ptrdiff_t(first), into.events.end(),
                         [&](const Event& event) { return event.t >= entry.t; });
        first = into.image_places.back() = std::size_t(next - into.events.begin());
    }
}

void EcdParser::parse(std::span<const std::byte> bytes, Batch& into) {
    const std::size_t before = into.events.size();
    events_->parse(bytes, into);
    if (into.events.size() == before) return;
    if (jumped_) {
        const SensorTime first = into.events[before].t;
        next_image_ = std::size_t(
            std::lower_bound(images_.entries.begin(), images_.entries.end(), first,
                             [](const auto& entry, SensorTime t) { return entry.t < t; }) -
            images_.entries.begin());
        jumped_ = false;
    }
    emit_until(into.events.back().t, before, into);
}

void EcdParser::finish(Batch& into) {
    events_->finish(into);
    if (!jumped_) emit_until({}, into.events.size(), into);
}

void EcdParser::resync() {
    events_->resync();
    jumped_ = true;
}

const Damage& EcdParser::damaged() const {
    damage_ = events_->damaged();
    damage_ += image_damage_;
    return damage_;
}

std::vector<std::string> EcdRecording::remarks() const {
    std::vector<std::string> all = events_->remarks();
    all.insert(all.end(), images_.remarks.begin(), images_.remarks.end());
    if (images_.width > 0 && (images_.width != info().width || images_.height != info().height))
        all.push_back("images.txt: expected images of the sensor's size, " +
                      size_text(info().width, info().height) + ", found one of " +
                      size_text(images_.width, images_.height) + "; such images are left out");
    return all;
}

}  // namespace eventide
