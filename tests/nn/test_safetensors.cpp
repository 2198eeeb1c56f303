// The tensor file: what goes in comes out, and nothing else is believed.
#include "src/core/error.h"
#include "src/nn/safetensors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

namespace eventide {
namespace {

using testing::HasSubstr;

std::vector<std::byte> file_of(const std::string& header, std::size_t data_bytes) {
    std::vector<std::byte> bytes(8 + header.size() + data_bytes);
    const std::uint64_t size = header.size();
    std::memcpy(bytes.data(), &size, 8);
    std::memcpy(bytes.data() + 8, header.data(), header.size());
    return bytes;
}

std::string refusal(const std::vector<std::byte>& bytes) {
    try {
        parse_safetensors(bytes, "m.safetensors");
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_THAT(error.what(), HasSubstr("m.safetensors"));
        return error.what();
    }
    return "accepted";
}

TensorFile sample() {
    return {{{"a", "1"}, {"b", "\"quoted\" \n"}},
            {{"scalar", {{}, {3}}},
             {"empty", {{0, 4}, {}}},
             {"matrix", {{2, 3}, {1, 2, 3, -4, 5e-30F, 6}}}}};
}

TEST(Safetensors, WhatIsWrittenIsRead) {
    EXPECT_EQ(parse_safetensors(format_safetensors(sample()), "x"), sample());
    EXPECT_EQ(parse_safetensors(format_safetensors({}), "x"), TensorFile{});
}

TEST(Safetensors, NumbersInTwoBytesAreRoundedToTheNearest) {
    const float largest = std::numeric_limits<float>::max(), third = 1.F / 3;
    TensorFile file = sample();
    file.tensors["odd"] = {{5}, {1, -2.5F, third, -largest, 1 + 1.F / 256}, true};
    const std::vector<std::byte> bytes = format_safetensors(file);
    const TensorFile read = parse_safetensors(bytes, "x");
    const Tensor& odd = read.tensors.at("odd");
    EXPECT_TRUE(odd.bf16);
    EXPECT_EQ(odd.values[0], 1);
    EXPECT_EQ(odd.values[1], -2.5F);
    EXPECT_NEAR(odd.values[2], third, third / 512);
    EXPECT_TRUE(std::isfinite(odd.values[3]));
    EXPECT_EQ(odd.values[4], 1) << "a tie goes to the even one";
    EXPECT_EQ(read.tensors.at("matrix"), file.tensors.at("matrix"));
    EXPECT_EQ(format_safetensors(read), bytes) << "what was rounded stays";
}

TEST(Safetensors, AFileOfAnyOtherLengthIsRefused) {
    auto bytes = format_safetensors(sample());
    for (std::size_t n = 0; n < bytes.size(); ++n)
        EXPECT_NE(refusal({bytes.begin(), bytes.begin() + std::ptrdiff_t(n)}), "accepted") << n;
    bytes.push_back({});
    EXPECT_NE(refusal(bytes), "accepted");
}

TEST(Safetensors, NumbersThatAreNotFiniteAreRefusedByName) {
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        TensorFile file = sample();
        file.tensors["matrix"].values[4] = bad;
        EXPECT_THAT(refusal(format_safetensors(file)), HasSubstr("'matrix': number 4"));
    }
}

TEST(Safetensors, HeadersThatLieAreRefusedByName) {
    const auto tensor = [](const std::string& body) { return "{\"t\":{" + body + "}}"; };
    const std::vector<std::pair<std::string, std::string>> lies{
        {tensor(R"("dtype":"F32","shape":[2],"data_offsets":[0,4])"), "'t': shape [2]"},
        {tensor(R"("dtype":"F32","shape":[1],"data_offsets":[0,8])"), "'t'"},
        {tensor(R"("dtype":"F32","shape":[3],"data_offsets":[0,12])"), "'t': expected data within"},
        {tensor(R"("dtype":"F32","shape":[1],"data_offsets":[8,4])"), "'t': expected data within"},
        {tensor(R"("dtype":"F16","shape":[2],"data_offsets":[0,4])"), "'t': expected dtype F32"},
        {tensor(R"("dtype":"F32","shape":[-1],"data_offsets":[0,4])"), "'t': shape"},
        {tensor(R"("dtype":"F32","shape":[1.5],"data_offsets":[0,4])"), "'t': shape"},
        {tensor(R"("dtype":"F32","shape":"1","data_offsets":[0,4])"), "'t'"},
        {tensor(R"("dtype":"F32","shape":[1],"data_offsets":[0])"), "'t': data_offsets"},
        {tensor(R"("dtype":"F32","shape":[1])"), "'t'"},
        {tensor(R"("dtype":"F32","shape":[4611686018427387904,4],"data_offsets":[0,4])"), "'t'"},
        {tensor(R"("dtype":"F32","shape":[2],"data_offsets":[4,12])"), "'t'"},
        {R"({"t":3})", "'t'"},
        {R"({"__metadata__":{"a":3}})", "'a'"},
        {R"({"__metadata__":[]})", "__metadata__"},
        {R"([1])", "not a safetensors file"},
        {R"({"t":)", "not a safetensors file"},
        {"", "not a safetensors file"},
    };
    for (const auto& [header, expected] : lies)
        EXPECT_THAT(refusal(file_of(header, 8)), HasSubstr(expected)) << header;
    const std::string one = R"("dtype":"F32","shape":[1],"data_offsets":)";
    EXPECT_THAT(refusal(file_of("{\"t\":{" + one + "[0,4]},\"t\":{" + one + "[0,4]}}", 4)),
                HasSubstr("'t' is described twice"));
    EXPECT_THAT(refusal(file_of("{\"t\":{" + one + "[0,4]},\"u\":{" + one + "[0,4]}}", 4)),
                HasSubstr("expected to begin"));
    EXPECT_EQ(refusal(file_of("{\"t\":{" + one + "[0,4]}}", 4)), "accepted");
}

TEST(Safetensors, AHugeHeaderIsRefusedWithoutBeingRead) {
    std::vector<std::byte> bytes(64);
    const std::uint64_t size = std::numeric_limits<std::uint64_t>::max();
    std::memcpy(bytes.data(), &size, 8);
    EXPECT_THAT(refusal(bytes), HasSubstr("truncated"));
}

TEST(Safetensors, FilesThatCannotBeReadAreNamed) {
    EXPECT_THROW(read_safetensors("/no/such/file"), Error);
    EXPECT_THROW(read_safetensors("/"), Error);
    EXPECT_THROW(write_safetensors("/no/such/folder/x", {}), Error);
}

}  // namespace
}  // namespace eventide
