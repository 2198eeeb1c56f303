// Pictures of an Event Camera Dataset folder, merged with its events by time.
#include "replay/ecd_folder.h"

#include "replay/image_file.h"
#include "src/codec/text_number.h"
#include "src/codec/text_row.h"

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

EcdImages read_ecd_images(const std::string& folder) {
    EcdImages images;
    std::ifstream file(fs::path(folder) / "images.txt");
    for (std::string line; std::getline(file, line);) {
        if (is_comment(line)) continue;
        const auto fields = split_fields(line);
        const auto time = fields.empty() ? std::nullopt : parse_decimal(fields[0]);
        const auto us = time ? scaled_integer(*time, 6) : std::nullopt;
        if (fields.size() < 2 || !us) {
            ++images.bad_entries;
            continue;
        }
        images.entries.push_back({from_us(*us), (fs::path(folder) / fields[1]).string()});
    }
    std::stable_sort(images.entries.begin(), images.entries.end(),
                     [](const auto& a, const auto& b) { return a.t < b.t; });
    for (const auto& entry : images.entries)
        if (const auto size = size_of_image_file(entry.path)) {
            images.width = size->width;
            images.height = size->height;
            break;
        }
    return images;
}

EcdParser::EcdParser(std::unique_ptr<Parser> events, EcdImages images)
    : events_(std::move(events)), images_(std::move(images)) {
    image_damage_.count(DamageReason::bad_record, images_.bad_entries);
}

/// Empty: all that are left.
void EcdParser::emit_until(std::optional<SensorTime> t, Batch& into) {
    for (; next_image_ < images_.entries.size(); ++next_image_) {
        const auto& entry = images_.entries[next_image_];
        if (t && entry.t > *t) break;
        std::optional<ReferenceImage> image = read_image_file(entry.path);
        if (!image) {
            image_damage_.count(DamageReason::bad_record);
            continue;
        }
        image->t = image->exposure_begin = image->exposure_end = entry.t;
        into.images.push_back(std::move(*image));
    }
}

void EcdParser::parse(std::span<const std::byte> bytes, Batch& into) {
    const std::size_t before = into.events.size();
    events_->parse(bytes, into);
    if (jumped_ && into.events.size() > before) {
        const SensorTime first = into.events[before].t;
        next_image_ = std::size_t(
            std::lower_bound(images_.entries.begin(), images_.entries.end(), first,
                             [](const auto& entry, SensorTime t) { return entry.t < t; }) -
            images_.entries.begin());
        jumped_ = false;
    }
    if (const auto now = events_->clock(); now && !jumped_) emit_until(now, into);
}

void EcdParser::finish(Batch& into) {
    events_->finish(into);
    if (!jumped_) emit_until({}, into);
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

}  // namespace eventide
