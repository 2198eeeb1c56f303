// own_source: a source and a sink of one's own around the pipeline of threads: a bright bar that
// moves over the sensor.
#include <eventide/eventide.hpp>

#include <iostream>

namespace {

/// 10 ms at a time: where the bar comes it gets brighter, where it was darker.
class MovingBar final : public eventide::EventSource {
public:
    const eventide::SensorInfo& info() const noexcept override { return info_; }
    bool read(eventide::Batch& batch) override {
        batch.clear();
        if (++step_ > 20) return false;
        for (int y = 8; y < 40; ++y) {
            batch.events.push_back(event(step_ + 10, y, eventide::Polarity::on));
            batch.events.push_back(event(step_, y, eventide::Polarity::off));
        }
        return true;
    }

private:
    eventide::Event event(int x, int y, eventide::Polarity polarity) const {
        return {eventide::from_us(10'000 * step_), std::uint16_t(x), std::uint16_t(y), polarity};
    }
    eventide::SensorInfo info_{
        .name = "moving bar", .serial = "", .format = "", .width = 64, .height = 48};
    int step_ = 0;
};

class Printer final : public eventide::FrameSink {
public:
    bool write(const eventide::Frame& frame) override {
        std::cout << to_us(frame.t) << " us: " << frame.intensity(24, 32) << " +- "
                  << frame.sigma(24, 32) << '\n';
        return bool(std::cout);
    }
};

}  // namespace

int main() try {
    MovingBar bar;
    Printer printer;
    eventide::EventPipeline pipeline(bar, {&printer}, "default", {.frames = {.fps = "50"}});
    pipeline.run();
} catch (const eventide::Error& error) {
    std::cerr << error.what() << '\n';
    return 1;
}
