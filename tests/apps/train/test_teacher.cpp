// A network that learns from the frames of a finished one.
#include "apps/train/teacher.h"
#include "src/core/error.h"
#include "tests/apps/train/tiny_run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

constexpr int kStreams = 2;

fs::path file_of(const ModelConfig& config, const std::string& folder) {
    const fs::path file = empty_folder(folder) / "teacher.safetensors";
    save_model(file, {config, to_tensors(initial_parameters(config, 7, torch::kCPU))});
    return file;
}

fs::path teacher_file(const std::string& folder, int bins = 2) {
    ModelConfig config = tiny_options({}).model;
    config.bins = bins;
    return file_of(config, folder);
}

DataSettings tiny_data() {
    DataSettings data = tiny_options({}).data;
    data.bins = 2;
    data.patch = 16;  // part of the crop, so that its place counts
    return data;
}

TrainingBatch batch_of(const DataSettings& data) {
    std::vector<StreamSegment> segments;
    for (int stream = 0; stream < kStreams; ++stream)
        segments.push_back(SceneStream{data, few_textures(), {.stream = stream}, 0}.next());
    return to_batch(segments, torch::kCPU);
}

double greatest_difference(const torch::Tensor& a, const torch::Tensor& b) {
    return (a - b).abs().max().item<double>();
}

TEST(Teacher, OfOneViewShowsWhatItsNetworkShows) {
    const fs::path file = teacher_file("teaches_one_view");
    const Teacher teacher{file, 1, torch::kCPU, torch::kFloat};
    const DataSettings data = tiny_data();
    const SegmentPlan plan = segment_plan(data, 0);
    const TrainingBatch batch = batch_of(data);
    auto states = teacher.empty_states(kStreams, data.crop);
    ASSERT_EQ(states.size(), 1U);
    const torch::Tensor frames = teacher.frames(plan, batch, data.patch, states);

    const Model model = load_model(file);
    RecurrentState state = empty_recurrent_state(model.config, kStreams, data.crop, data.crop, {});
    const Parameters parameters = to_parameters(model.weights, torch::kCPU);
    const torch::Tensor mu =
        run_segment(model.config, parameters, plan, batch, data.patch, state).mu.detach();
    EXPECT_EQ(greatest_difference(frames, mu.clamp(0, 1)), 0);
    EXPECT_EQ(greatest_difference(states[0].latent, state.latent.detach()), 0) << "it remembers";
    EXPECT_FALSE(frames.requires_grad());
}

/// What a teacher makes of a scene, and of the same scene mirrored along `axes`, mirrored back.
double difference_when_mirrored(int views, const std::vector<std::int64_t>& axes) {
    const DataSettings data = tiny_data();
    const SegmentPlan plan{
        .first_rendered = 1, .y0 = 3, .x0 = 9, .span = 15, .lookahead = {0, 1, 2}};
    SegmentPlan mirrored_plan = plan;
    TrainingBatch mirrored = batch_of(data);
    for (const std::int64_t axis : axes) {
        double& begin = axis == -2 ? mirrored_plan.y0 : mirrored_plan.x0;
        begin = data.crop - 1 - begin - plan.span;
    }
    for (torch::Tensor& grid : mirrored.grids) grid = grid.flip(axes);

    const Teacher teacher{teacher_file("teaches_mirrored"), views, torch::kCPU, torch::kFloat};
    auto states = teacher.empty_states(kStreams, data.crop);
    auto mirrored_states = states;
    const auto frames = teacher.frames(plan, batch_of(data), data.patch, states),
               others = teacher.frames(mirrored_plan, mirrored, data.patch, mirrored_states);
    return greatest_difference(frames, others.flip(axes));
}

TEST(Teacher, OfTwoViewsShowsATurnedSceneTurnedAndOfFourAMirroredOneMirrored) {
    constexpr double kSame = 1e-5, kOther = 1e-3;
    EXPECT_GT(difference_when_mirrored(1, {-2, -1}), kOther) << "one network sees them differently";
    EXPECT_LT(difference_when_mirrored(2, {-2, -1}), kSame);
    EXPECT_GT(difference_when_mirrored(2, {-1}), kOther);
    EXPECT_LT(difference_when_mirrored(4, {-2, -1}), kSame);
    EXPECT_LT(difference_when_mirrored(4, {-1}), kSame);
    EXPECT_LT(difference_when_mirrored(4, {-2}), kSame);
}

TEST(Teacher, ReadsTheSameEventsWithBinsOfItsOwn) {
    DataSettings data = tiny_data();
    data.teacher_bins = 3;
    DataSettings alone = data;
    alone.bins = 3;
    alone.teacher_bins = 0;
    const StreamSegment both = SceneStream{data, few_textures(), {}, 0}.next(),
                        only = SceneStream{alone, few_textures(), {}, 0}.next();
    EXPECT_TRUE(only.teacher_grids.empty());
    ASSERT_EQ(both.teacher_grids.size(), only.grids.size());
    for (std::size_t k = 0; k < only.grids.size(); ++k)
        EXPECT_TRUE(std::ranges::equal(both.teacher_grids[k].values(), only.grids[k].values()));

    const Teacher teacher{teacher_file("teaches_by_bins", 3), 2, torch::kCPU, torch::kFloat};
    EXPECT_EQ(teacher.bins(), 3);
    auto states = teacher.empty_states(1, data.crop), expected_states = states;
    const SegmentPlan plan = segment_plan(data, 0);
    const auto frames = teacher.frames(plan, to_batch({&both, 1}, torch::kCPU), data.patch, states);
    const auto expected =
        teacher.frames(plan, to_batch({&only, 1}, torch::kCPU), data.patch, expected_states);
    EXPECT_EQ(greatest_difference(frames, expected), 0);
}

TEST(Teacher, ForgetsASceneThatIsOver) {
    const Teacher teacher{teacher_file("teaches_anew"), 2, torch::kCPU, torch::kFloat};
    const DataSettings data = tiny_data();
    const SegmentPlan plan = segment_plan(data, 0);
    TrainingBatch batch = batch_of(data);
    auto states = teacher.empty_states(kStreams, data.crop);
    const auto first = teacher.frames(plan, batch, data.patch, states);
    batch.fresh = {true, false};
    const auto second = teacher.frames(plan, batch, data.patch, states);
    const auto of_stream = [&](const torch::Tensor& frames, int stream) {
        return frames.slice(0, stream, {}, kStreams);
    };
    EXPECT_EQ(greatest_difference(of_stream(first, 0), of_stream(second, 0)), 0);
    EXPECT_GT(greatest_difference(of_stream(first, 1), of_stream(second, 1)), 1e-4);
}

TEST(Teacher, OfAMemoryAtHalfTheResolutionIsRefused) {
    ModelConfig config = tiny_options({}).model;
    config.latent_stride = 2;
    const fs::path file = file_of(config, "teaches_half");
    try {
        const Teacher teacher{file, 2, torch::kCPU, torch::kFloat};
        FAIL() << "taken";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        EXPECT_NE(std::string{error.what()}.find(file.string()), std::string::npos) << error.what();
    }
}

TEST(Training, ATeachersFramesDrawMuNearerToThem) {
    const fs::path file = teacher_file("teaches_a_run");
    const auto l1_of_run = [&](double share) {
        TrainOptions options = tiny_options(empty_folder("taught"));
        options.teacher = file.string();
        options.teacher_share = share;
        options.model.bins = 1;  // another network than the teacher's
        options.steps = 60;
        const auto run = trainer(options);
        train(*run);

        const DataSettings data = tiny_data();
        DataSettings narrow = data;
        narrow.bins = 1;
        const SegmentPlan plan = segment_plan(data, 0);
        const Teacher teacher{file, 2, torch::kCPU, torch::kFloat};
        auto states = teacher.empty_states(kStreams, data.crop);
        const auto frames = teacher.frames(plan, batch_of(data), data.patch, states);
        RecurrentState state =
            empty_recurrent_state(options.model, kStreams, data.crop, data.crop, {});
        const auto mu =
            run_segment(options.model, run->parameters(), plan, batch_of(narrow), data.patch, state)
                .mu;
        return (mu - frames).abs().mean().item<double>();
    };
    const double taught = l1_of_run(1), untaught = l1_of_run(0);
    EXPECT_LT(taught, .5 * untaught);
}

TEST(Training, ATaughtRunThatStoppedGoesOnAsIfItHadNot) {
    TrainOptions options = tiny_options(empty_folder("taught_whole"));
    options.teacher = teacher_file("teaches_twice", 3).string();
    options.steps = 8;
    expect_stopping_changes_nothing(options, 5);
}

TEST(Training, ATaughtRunGoesOnWithAnotherTeacher) {
    TrainOptions options = tiny_options(empty_folder("taught_by_another"));
    options.teacher = teacher_file("teaches_first").string();
    options.threads = 1;
    options.steps = 2;
    train(*trainer(options));
    options.resume = (fs::path{options.out} / "checkpoint.safetensors").string();
    options.steps = 4;
    // The same codes, made by a wider network and by a deeper one.
    ModelConfig wider = tiny_options({}).model, deeper = wider;
    wider.widths = {8, 12};
    deeper.widths = {8, 8, 8};
    deeper.recurrent = {1, 1, 1};
    for (const ModelConfig& config : {wider, deeper}) {
        options.teacher = file_of(config, "teaches_then").string();
        const auto run = trainer(options);
        train(*run);
        EXPECT_EQ(run->steps(), 4);
    }
}

}  // namespace
}  // namespace eventide
