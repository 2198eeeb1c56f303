// Filters one behind the other.
#include "pipeline/filters/filter_chain.h"

#include "src/core/list_text.h"

#include <iterator>
#include <utility>

namespace eventide {

namespace {

template <typename T>
void append(std::vector<T>& more, std::vector<T>& to) {
    to.insert(to.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

/// Leaves `more` with what was moved from.
void append(Batch& more, Batch& to) {
    if (to.empty()) return std::swap(more, to);
    const std::size_t before = to.events.size();
    for (std::size_t i = 0; i < more.images.size(); ++i) {
        to.add_image(std::move(more.images[i]));
        to.image_places.back() = before + more.place_of_image(i);
    }
    append(more.events, to.events);
    append(more.imu, to.imu);
    append(more.triggers, to.triggers);
}

/// Filters what another parser gives.
class FilteringParser final : public Parser {
public:
    FilteringParser(std::unique_ptr<Parser> parser, FilterChain& chain)
        : parser_(std::move(parser)), chain_(chain) {}

    void parse(std::span<const std::byte> bytes, Batch& into) override {
        parser_->parse(bytes, batch_);
        pass_on(into);
    }
    void finish(Batch& into) override {
        parser_->finish(batch_);
        pass_on(into);
    }
    void resync() override { parser_->resync(); }
    void reopened() override { parser_->reopened(); }
    void arrives(HostTime t) override { parser_->arrives(t); }
    std::optional<SensorTime> clock() const override { return parser_->clock(); }
    const Damage& damaged() const override { return parser_->damaged(); }

private:
    void pass_on(Batch& into) {
        chain_.process(batch_);
        append(batch_, into);
        batch_.clear();
    }

    std::unique_ptr<Parser> parser_;
    FilterChain& chain_;
    Batch batch_;
};

}  // namespace

FilterChain::FilterChain(const std::vector<std::string>& texts, const SensorPixels& size)
    : size_before_(size), size_(size) {
    for (const std::string& text : texts) add(text);
}

void FilterChain::add(const std::string& text) {
    auto filter = make_data_filter(text, size_);
    Link& link = links_.emplace_back();
    link.text = text;
    link.filter = std::move(filter);
    size_ = link.filter->size();
}

void FilterChain::restart() {
    std::vector<std::unique_ptr<DataFilter>> anew;
    SensorPixels size = size_before_;
    for (const Link& link : links_) {
        anew.push_back(make_data_filter(link.text, size));
        size = anew.back()->size();
        if (first_) anew.back()->count_from(*first_);
    }
    for (std::size_t i = 0; i < anew.size(); ++i) links_[i].filter = std::move(anew[i]);
}

ColourFilter FilterChain::pattern(ColourFilter before) const {
    for (const Link& link : links_) before = link.filter->pattern(before);
    return before;
}

SensorInfo FilterChain::behind(SensorInfo sensor) const {
    sensor.width = size_.width;
    sensor.height = size_.height;
    sensor.colour_filter = pattern(sensor.colour_filter);
    return sensor;
}

/// In pieces: filters that leave out events need not know which images they stand among.
void FilterChain::process(Batch& batch) {
    pieces_.put(batch);
    while (pieces_.next(piece_)) {
        process_piece(piece_);
        append(piece_, batch);
    }
}

/// Times count from the recording's first event, whatever filters leave of the beginning.
void FilterChain::process_piece(Batch& batch) {
    if (!first_ && !batch.events.empty()) count_from(batch.events.front().t);
    for (Link& link : links_) {
        const std::size_t before = batch.events.size();
        link.filter->process(batch);
        link.left_out.add(before - batch.events.size());
    }
}

std::uint64_t FilterChain::left_out() const {
    std::uint64_t sum = 0;
    for (const Link& link : links_) sum += link.left_out.value();
    return sum;
}

std::string FilterChain::report() const {
    std::string text;
    for (const Link& link : links_)
        add_to_list(text, link.text + " " + std::to_string(link.left_out.value()));
    return text;
}

FilteredSource::FilteredSource(Source& source, FilterChain& chain)
    : source_(source), chain_(chain), info_(chain.behind(source.info())) {}

std::unique_ptr<Parser> FilteredSource::make_parser() const {
    return std::make_unique<FilteringParser>(source_.make_parser(), chain_);
}

}  // namespace eventide
