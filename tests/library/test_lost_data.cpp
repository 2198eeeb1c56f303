// Frames tell of data that were lost before them.
#include "tests/library/library_test.h"

#include <cstddef>
#include <span>
#include <vector>

namespace eventide::test {
namespace {

class LostData : public LibraryTest {};

TEST_F(LostData, IsMarkedInItsFrameHoweverLateThatIsAskedFor) {
    Reconstructor reconstructor = this->reconstructor(repeatable("20ms", 0));
    const auto events = events_of(recording());
    const auto half = events.size() / 2;
    reconstructor.push(std::span{events}.first(half));
    reconstructor.mark_gap();
    reconstructor.push(std::span{events}.subspan(half));
    reconstructor.finish();
    int marked = 0;
    for (Frame frame; reconstructor.next(frame);) {
        const bool has_lost =
            frame.window.begin < events[half].t && events[half].t <= frame.window.end;
        EXPECT_EQ(frame.gap_before, has_lost) << to_us(frame.t);
        marked += frame.gap_before ? 1 : 0;
    }
    EXPECT_GT(marked, 0);
}

/// Loses data before its last batch.
class LossySource final : public EventSource {
public:
    explicit LossySource(const std::vector<Event>& events) : events_(events) {
        info_.width = 64;
        info_.height = 48;
    }
    const SensorInfo& info() const noexcept override { return info_; }
    bool read(Batch& batch) override {
        batch.clear();
        if (batches_ == 2) return false;
        const auto half = std::ptrdiff_t(events_.size() / 2);
        batch.events.assign(batches_ == 0 ? events_.begin() : events_.begin() + half,
                            batches_ == 0 ? events_.begin() + half : events_.end());
        ++batches_;
        return true;
    }
    bool gap_before() const noexcept override { return batches_ == 2; }

private:
    SensorInfo info_;
    std::vector<Event> events_;
    int batches_ = 0;
};

TEST_F(LostData, MakeTheStateBeginAnewWhereThatIsAsked) {
    // What the network remembers of events that came before data were lost.
    const auto state_after = [this](std::uint16_t early_x, bool reset_on_gap) {
        ReconstructorOptions options = repeatable("7ms", 0);
        options.reset_on_gap = reset_on_gap;
        options.allow_silence = true;
        Reconstructor reconstructor = this->reconstructor(options);
        std::vector<Event> events{{from_us(1), 1, 1, Polarity::on}};
        for (int i = 0; i < 20; ++i)
            events.push_back({from_us(1000 + 10 * i), early_x, std::uint16_t(i), Polarity::on});
        events.push_back({from_us(30'000), 5, 5, Polarity::on});
        reconstructor.push(events);
        reconstructor.mark_gap();
        reconstructor.push(std::vector<Event>{{from_us(60'000), 7, 7, Polarity::off}});
        reconstructor.finish();
        Frame frame;
        while (reconstructor.next(frame)) continue;
        return reconstructor.state();
    };
    EXPECT_TRUE(state_after(10, true) == state_after(50, true));
    EXPECT_FALSE(state_after(10, false) == state_after(50, false));
}

TEST_F(LostData, OfASourceAreMarkedToo) {
    const auto events = events_of(recording());
    LossySource source{events};
    Reconstructor reconstructor = this->reconstructor(repeatable("20ms", 0));
    const SensorTime lost = events[events.size() / 2].t;
    int marked = 0;
    for (Frame frame; read_frame(source, reconstructor, frame);) {
        EXPECT_EQ(frame.gap_before, frame.window.begin < lost && lost <= frame.window.end);
        marked += frame.gap_before ? 1 : 0;
    }
    EXPECT_GT(marked, 0);
}

TEST_F(LostData, IsMarkedInTheNextFrame) {
    Reconstructor reconstructor = this->reconstructor(repeatable("20ms", 0));
    const auto events = events_of(recording());
    const auto half = events.size() / 2;
    reconstructor.push(std::span{events}.first(half));
    Frame frame;
    while (reconstructor.next(frame)) EXPECT_FALSE(frame.gap_before);
    reconstructor.mark_gap();
    reconstructor.push(std::span{events}.subspan(half));
    ASSERT_TRUE(reconstructor.next(frame));
    EXPECT_TRUE(frame.gap_before);
    reconstructor.render(frame.t, frame);
    EXPECT_TRUE(frame.gap_before);
}

TEST_F(LostData, IsToldByAFrameOfManyWindows) {
    ReconstructorOptions options = repeatable("2ms", 0);
    options.fps = "50";  // ten event windows for each frame
    Reconstructor reconstructor = this->reconstructor(options);
    const auto events = events_of(recording());
    const auto half = events.size() / 2;
    Frame frame;
    int marked = 0;
    const auto count = [&] {
        while (reconstructor.next(frame)) marked += frame.gap_before ? 1 : 0;
    };
    reconstructor.push(std::span{events}.first(half));
    count();
    EXPECT_EQ(marked, 0);
    reconstructor.mark_gap();
    reconstructor.push(std::span{events}.subspan(half));
    reconstructor.finish();
    count();
    EXPECT_EQ(marked, 1);
}

TEST_F(LostData, IsForgottenByAReset) {
    ReconstructorOptions options = repeatable("2ms", 0);
    options.fps = "1";
    Reconstructor reconstructor = this->reconstructor(options);
    const auto events = events_of(recording());
    const auto half = events.size() / 2;
    Frame frame;
    reconstructor.push(std::span{events}.first(half));
    ASSERT_TRUE(reconstructor.next(frame));
    reconstructor.mark_gap();
    reconstructor.push(std::span{events}.subspan(half));
    ASSERT_FALSE(reconstructor.next(frame)) << "no frame has told of the gap";
    reconstructor.reset();
    reconstructor.push(events);
    ASSERT_TRUE(reconstructor.next(frame));
    EXPECT_FALSE(frame.gap_before);
}

}  // namespace
}  // namespace eventide::test
