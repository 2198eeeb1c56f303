// One image of a whole run: rows of events, intensity, sigma and truth.
#include "pipeline/sinks/contact_sheet.h"

#include "src/core/error.h"
#include "src/io/image_codecs.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <span>
#include <string>
#include <utility>

namespace eventide {

namespace {

constexpr int kGap = 4, kCaption = 22;  // px
constexpr int kRowGap = 10;             // a time is seen to belong to the row above it
const cv::Scalar kPaper{255, 255, 255}, kInk{40, 40, 40};

/// As colour, at the given size; nearest neighbour keeps single events visible.
cv::Mat fitted(const cv::Mat& image, cv::Size size) {
    cv::Mat coloured = image, scaled;
    if (image.channels() == 1) cv::cvtColor(image, coloured, cv::COLOR_GRAY2BGR);
    cv::resize(coloured, scaled, size, 0, 0, cv::INTER_NEAREST);
    return scaled;
}

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX, kIndent = 2;
constexpr double kFontScale = 0.5;

void caption(cv::Mat& sheet, const std::string& text, int x, int y) {
    cv::putText(sheet, text, {x + kIndent, y + 16}, kFont, kFontScale, kInk, 1, cv::LINE_AA);
}

int width_of(const std::string& caption) {
    int below = 0;
    return kIndent + cv::getTextSize(caption, kFont, kFontScale, 1, &below).width;
}

}  // namespace

ContactSheetSink::ContactSheetSink(ContactSheetSettings settings) : settings_{std::move(settings)} {
    refuse_existing(settings_.path, settings_.overwrite);
    if (!can_write_image(settings_.path.string()))
        throw Error(ErrorKind::usage,
                    settings_.path.string() + ": expected the name of an image, such as sheet.png");
}

void ContactSheetSink::write(const Frame& frame) {
    if (frames_ == 0) first_ = frame.t;
    draw_truth_until(frame.t - kTruthDelay);
    if (frames_++ % stride_ != 0) return;
    kept_.push_back(row_of(frame));
    if (kept_.size() > 4 * std::size_t(settings_.rows)) drop_every_other();
}

void ContactSheetSink::drop_every_other() {
    for (std::size_t i = 0; 2 * i < kept_.size(); ++i) std::swap(kept_[i], kept_[2 * i]);
    kept_.resize((kept_.size() + 1) / 2);
    stride_ *= 2;
}

ContactSheetSink::Row ContactSheetSink::row_of(const Frame& frame) const {
    const cv::Size size{frame.intensity.width(), frame.intensity.height()};
    Row row;
    row.t = frame.t;
    row.window = frame.window;
    row.waits_for_truth = bool(settings_.draw_truth);
    cv::Mat image;
    draw(frame, Uncertainty::none, 1.0f, image);
    row.intensity = fitted(image, size);
    if (!frame.sigma.empty()) {
        draw_sigma(frame, settings_.sigma_white, image);
        row.sigma = fitted(image, size);
    }
    draw_events(frame, image);
    if (!image.empty()) row.events = fitted(part_of(image, settings_.part), size);
    return row;
}

void ContactSheetSink::draw_truth_until(SensorTime t) {
    for (Row& row : kept_) {
        if (!row.waits_for_truth || row.t > t) continue;
        row.waits_for_truth = false;
        cv::Mat truth;
        settings_.draw_truth(row.t, row.window, truth);
        if (!truth.empty())
            row.truth = fitted(part_of(truth, settings_.part), row.intensity.size());
    }
}

cv::Mat ContactSheetSink::lay_out(const std::vector<Row>& rows) const {
    using Column = std::pair<const char*, cv::Mat Row::*>;
    std::vector<Column> columns;
    for (const Column& column : {Column{"events", &Row::events},
                                 {"intensity", &Row::intensity},
                                 {"sigma", &Row::sigma},
                                 {settings_.truth_caption.c_str(), &Row::truth}})
        for (const Row& row : rows)
            if (!(row.*column.second).empty()) {
                columns.push_back(column);
                break;
            }
    const cv::Size cell = rows.front().intensity.size();
    int column_width = cell.width;  // of a small sensor captions are wider than images
    for (const Column& column : columns)
        column_width = std::max(column_width, width_of(column.first));
    const int width = int(columns.size()) * (column_width + kGap) + kGap;
    const int pitch = cell.height + kCaption + kRowGap;
    const int height = kCaption + int(rows.size()) * pitch - kRowGap;
    cv::Mat sheet(height, width, CV_8UC3, kPaper);
    for (std::size_t c = 0; c < columns.size(); ++c) {
        const int x = kGap + int(c) * (column_width + kGap);
        caption(sheet, columns[c].first, x, 0);
        for (std::size_t r = 0; r < rows.size(); ++r) {
            const int y = kCaption + int(r) * pitch;
            const cv::Mat& image = rows[r].*columns[c].second;
            if (!image.empty()) image.copyTo(sheet(cv::Rect({x, y}, cell)));
            char text[32];
            std::snprintf(text, sizeof text, "%.3f s",
                          std::chrono::duration<double>(rows[r].t - first_).count());
            if (c == 0) caption(sheet, text, x, y + cell.height);
        }
    }
    return sheet;
}

void ContactSheetSink::close() {
    if (std::exchange(closed_, true) || kept_.empty()) return;
    draw_truth_until(SensorTime::max());
    const std::size_t count = std::min(kept_.size(), std::size_t(settings_.rows));
    std::vector<Row> rows;
    // Middles of equal parts: the first frames, before the network has seen much, do not stand for
    // the run.
    for (std::size_t i = 0; i < count; ++i)
        rows.push_back(kept_[(2 * i + 1) * kept_.size() / (2 * count)]);
    std::vector<unsigned char> bytes;
    if (!encode_image(settings_.path.extension().string(), lay_out(rows), bytes))
        throw Error(ErrorKind::failed, settings_.path.string() + ": cannot be encoded");
    OutputFile file{settings_.path,
                    {.overwrite = settings_.overwrite,
                     .give_up = settings_.give_up,
                     .unread = settings_.unread}};
    file.write(std::as_bytes(std::span{bytes}));
    file.close();
}

}  // namespace eventide
