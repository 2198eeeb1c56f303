// The hidden state as a file: what comes back, and what is refused and why.
#include "src/core/error.h"
#include "src/model/encode/encoder.h"
#include "tests/model/streams.h"
#include "tests/support/random_model.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace eventide {
namespace {

namespace fs = std::filesystem;

class StateFile : public testing::Test {
protected:
    StateFile() {
        const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::temp_directory_path() /
                  ("eventide_state_" + std::to_string(getpid()) + "_" + test.name());
        fs::create_directories(folder_);
    }
    ~StateFile() override { fs::remove_all(folder_); }

    fs::path file() const { return folder_ / "state.safetensors"; }
    /// Where the file is refused, why; else nothing.
    std::string refusal(Encoder& encoder) const {
        try {
            encoder.restore(read_safetensors(file()), file());
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::input);
            return error.what();
        }
        return {};
    }

    fs::path folder_;
    ModelConfig config_ = test::small_config();
    Model model_ = test::random_model(config_, 2);
};

TEST_F(StateFile, GoesOnWhereItWasSaved) {
    for (const ModelConfig& config : {test::small_config(), test::thesis_config()}) {
        const Model model = test::random_model(config, 2);
        Encoder first{model, 41, 30}, second{model, 41, 30};
        test::GridStream stream{config, 30, 41, 1};
        LatentMap a = first.make_output(), b = second.make_output();
        for (int i = 0; i < 5; ++i) first.encode(stream.next(), a);
        write_safetensors(file(), first.state());
        second.restore(read_safetensors(file()), file());
        for (int i = 0; i < 3; ++i) {
            const VoxelGrid& grid = stream.next();
            first.encode(grid, a);
            second.encode(grid, b);
            ASSERT_EQ(a.values, b.values) << "step " << i;
        }
    }
}

TEST_F(StateFile, CutAnywhereItIsRefusedAndTheEncoderIsAsItWas) {
    Encoder encoder{model_, 41, 30};
    test::GridStream stream{config_, 30, 41, 1};
    LatentMap z = encoder.make_output();
    encoder.encode(stream.next(), z);
    const TensorFile before = encoder.state();
    write_safetensors(file(), before);
    const auto whole = fs::file_size(file());
    for (const std::uintmax_t size : {std::uintmax_t{0}, std::uintmax_t{5}, std::uintmax_t{60},
                                      whole / 4, whole / 2, whole - 4, whole - 1}) {
        write_safetensors(file(), before);
        fs::resize_file(file(), size);
        const std::string why = refusal(encoder);
        EXPECT_NE(why.find(file().string()), std::string::npos)
            << size << " bytes: '" << why << "'";
        EXPECT_EQ(encoder.state(), before) << size << " bytes";
    }
    write_safetensors(file(), before);
    EXPECT_EQ(refusal(encoder), "") << "the whole file is accepted";
}

TEST_F(StateFile, OfAnotherModelOrSizeIsRefusedByWhatDiffers) {
    Encoder encoder{model_, 41, 30};
    write_safetensors(file(), Encoder{test::random_model(config_, 3), 41, 30}.state());
    EXPECT_NE(refusal(encoder).find("'model'"), std::string::npos);
    write_safetensors(file(), Encoder{model_, 42, 30}.state());
    EXPECT_NE(refusal(encoder).find("'width': expected 41, found 42"), std::string::npos);
    write_safetensors(file(),
                      Encoder{test::random_model(test::thesis_config(), 3), 41, 30}.state());
    EXPECT_NE(refusal(encoder).find("'model'"), std::string::npos);
}

TEST_F(StateFile, SomethingElseIsRefused) {
    Encoder encoder{model_, 41, 30};
    EXPECT_NE(refusal(encoder).find(file().string()), std::string::npos) << "no such file";
    std::ofstream{file()} << "0.1 3 4 1\n0.2 5 6 0\n";
    EXPECT_NE(refusal(encoder).find(file().string()), std::string::npos) << "a recording";
    write_safetensors(file(), {{}, model_.weights});
    EXPECT_NE(refusal(encoder).find("'format': expected eventide-state"), std::string::npos);
}

TEST_F(StateFile, NumbersThatAreNoneAreRefusedByTensor) {
    Encoder encoder{model_, 41, 30};
    TensorFile state = encoder.state();
    state.tensors.at("h.1").values[7] = std::numeric_limits<float>::quiet_NaN();
    const std::vector<std::byte> bytes = format_safetensors(state);
    std::ofstream{file(), std::ios::binary}.write(reinterpret_cast<const char*>(bytes.data()),
                                                  std::streamsize(bytes.size()));
    EXPECT_NE(refusal(encoder).find("h.1"), std::string::npos);
}

}  // namespace
}  // namespace eventide
