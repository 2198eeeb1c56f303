// Real recordings through the pipeline: the same frames on four threads, for other splits of the
// bytes.
#include "pipeline/pipeline.h"
#include "replay/formats.h"
#include "tests/support/toy_stages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

namespace eventide {
namespace {

using namespace test;

/// A recording whose packets come in other pieces.
class OtherwiseSplit final : public Source {
public:
    OtherwiseSplit(Source& whole, unsigned seed) : whole_(whole), rng_(seed) {}
    const SensorInfo& info() const override { return whole_.info(); }
    bool is_live() const noexcept override { return false; }
    void stop() noexcept override { whole_.stop(); }
    std::unique_ptr<Parser> make_parser() const override { return whole_.make_parser(); }
    ReadStatus read(RawPacket& into) override {
        if (given_ == packet_.bytes.size()) {
            if (whole_.read(packet_) == ReadStatus::end) return ReadStatus::end;
            given_ = 0;
        }
        const std::size_t wanted = rng_() % 3 == 0 ? 1 + rng_() % 50 : 1 + rng_() % 200'000;
        const auto n = std::min(wanted, packet_.bytes.size() - given_);
        const auto first = packet_.bytes.begin() + std::ptrdiff_t(given_);
        into.bytes.assign(first, first + std::ptrdiff_t(n));
        into.arrived = packet_.arrived;
        given_ += n;
        return ReadStatus::data;
    }

private:
    Source& whole_;
    std::mt19937 rng_;
    RawPacket packet_;
    std::size_t given_ = 0;
};

/// Keeps a digest of each frame: the frames would take gigabytes.
class DigestSink final : public Sink {
public:
    void write(const Frame& frame) override {
        std::uint64_t hash = 0xCBF29CE484222325;  // FNV-1a, on words
        const auto mix = [&hash](std::uint64_t word) { hash = (hash ^ word) * 0x100000001B3; };
        mix(std::uint64_t(to_us(frame.t)));
        mix(std::uint64_t(to_us(frame.window.begin)));
        mix(std::uint64_t(to_us(frame.window.end)));
        mix(frame.index);
        mix(frame.events);
        for (const float value : frame.intensity.values()) mix(std::bit_cast<std::uint32_t>(value));
        for (const float value : frame.sigma.values()) mix(std::bit_cast<std::uint32_t>(value));
        digests.push_back(hash);
    }
    std::vector<std::uint64_t> digests;
};

struct Outcome {
    std::vector<std::uint64_t> digests;
    Snapshot snapshot;
};

enum class How { sequential, threaded, threaded_otherwise_split };

Outcome run(const std::string& path, const PipelineSettings& settings, How how) {
    const auto recording = open_recording(path);
    OtherwiseSplit split(*recording, 7);
    Source& source =
        how == How::threaded_otherwise_split ? static_cast<Source&>(split) : *recording;
    ToyEncoder encoder(source.info().height, source.info().width);
    ToyRenderer renderer(source.info().height, source.info().width);
    DigestSink sink;
    Pipeline pipeline({source, encoder, renderer, {&sink}}, settings);
    how == How::sequential ? pipeline.run_sequential() : pipeline.run();
    return {std::move(sink.digests), pipeline.snapshot()};
}

class RealRecordings : public testing::TestWithParam<const char*> {
protected:
    std::string path() const {
        return std::string{EVENTIDE_SOURCE_DIR "/../shared/data/"} + GetParam();
    }
    void SetUp() override {
        if (!std::filesystem::exists(path())) GTEST_SKIP() << "no recordings here: " << path();
    }
};

TEST_P(RealRecordings, GiveTheSameFramesThreadedAsSequential) {
    std::vector<PipelineSettings> variants(2);
    variants[0].rate = {2997, 100};
    variants[0].lookahead = 2;
    variants[0].event_windows.slicer = parse_window("20ms");
    variants[1].bins = 2;
    variants[1].event_windows.slicer = parse_window("0.35epp,40ms");
    for (const PipelineSettings& settings : variants) {
        SCOPED_TRACE(window_text(settings.event_windows.slicer));
        const Outcome expected = run(path(), settings, How::sequential);
        EXPECT_FALSE(expected.digests.empty());
        EXPECT_GT(expected.snapshot.events, 1000U);
        for (const How how : {How::threaded, How::threaded_otherwise_split}) {
            const Outcome found = run(path(), settings, how);
            EXPECT_EQ(found.digests, expected.digests) << int(how);
            EXPECT_EQ(found.snapshot.events, expected.snapshot.events);
            EXPECT_EQ(found.snapshot.damaged, expected.snapshot.damaged);
        }
    }
}

class RealRecordingsWithImages : public RealRecordings {};

TEST_P(RealRecordingsWithImages, AreCutAtThem) {
    PipelineSettings settings;
    settings.event_windows.slicer = parse_window("aps");
    const Outcome expected = run(path(), settings, How::sequential);
    EXPECT_GE(expected.digests.size() + 1, expected.snapshot.images);
    EXPECT_EQ(expected.snapshot.slicing.late_references, 0U);
    EXPECT_EQ(run(path(), settings, How::threaded_otherwise_split).digests, expected.digests);
}

std::string name_of_file(const testing::TestParamInfo<const char*>& instance) {
    std::string name = std::filesystem::path{instance.param}.filename().string();
    std::replace_if(
        name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
    return name;
}

INSTANTIATE_TEST_SUITE_P(All, RealRecordings,
                         testing::Values("recordings/slider_depth_head", "recordings/davis346_desk",
                                         "formats/davis346_robotarm.aedat4",
                                         "formats/davis346_desk.aedat4",
                                         "formats/davis240_imu_rotdisk.aedat2",
                                         "formats/dvs128_short.aedat2"),
                         name_of_file);
INSTANTIATE_TEST_SUITE_P(All, RealRecordingsWithImages,
                         testing::Values("recordings/slider_depth_head", "recordings/davis346_desk",
                                         "formats/davis346_robotarm.aedat4",
                                         "formats/davis346_desk.aedat4"),
                         name_of_file);

}  // namespace
}  // namespace eventide
