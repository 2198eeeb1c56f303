// A profile as JSON.
#include "apps/cli/run/quality/quality_profile.h"

#include "apps/cli/printable.h"
#include "src/core/arithmetic_words.h"
#include "src/core/error.h"
#include "src/io/shallow_json.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace eventide::app {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "eventide-quality-profile";
constexpr int kVersion = 1;

Json json_of(const ProfileKey& key) {
    return {{"processor", key.processor}, {"instructions", key.instructions},
            {"kernels", key.kernels},     {"eventide", key.version},
            {"model", key.model},         {"identity", key.identity},
            {"width", key.width},         {"height", key.height}};
}

[[noreturn]] void refuse(const std::string& expected, const std::string& found) {
    throw Error(ErrorKind::input, "expected " + expected + ", found " + found);
}

const Json& member(const Json& json, const char* name) {
    if (!json.is_object() || !json.contains(name)) refuse("\"" + std::string{name} + "\"", "none");
    return json.at(name);
}

/// More than nothing, less than an hour.
double milliseconds(const Json& json, const char* name) {
    const Json& value = member(json, name);
    constexpr double kMax = 3.6e6;
    if (!value.is_number() || !(value.get<double>() > 0) || value.get<double>() > kMax)
        refuse(std::string{name} + " above 0 ms", value.dump());
    return value.get<double>();
}

PrecisionCost precision_cost(const Json& json) {
    const Json &name = member(json, "precision"), &engine = member(json, "engine");
    const auto precision =
        find_word(name.is_string() ? name.get<std::string>() : "", kPrecisionWords);
    if (!precision || *precision == Precision::automatic) refuse("f32 or bf16", name.dump());
    if (!engine.is_string()) refuse("the engine's name", engine.dump());
    return {*precision,
            engine.get<std::string>(),
            milliseconds(json, "encode_ms"),
            milliseconds(json, "first_ms"),
            milliseconds(json, "full_ms"),
            milliseconds(json, "half_ms"),
            milliseconds(json, "third_ms")};
}

void check_key(const Json& found, const ProfileKey& key) {
    const Json expected = json_of(key);
    for (const auto& [name, value] : expected.items())
        if (member(found, name.c_str()) != value)
            refuse(name + " " + value.dump(), found.at(name).dump());
}

}  // namespace

const PrecisionCost* QualityProfile::of(Precision precision) const {
    const auto found = std::ranges::find(costs, precision, &PrecisionCost::precision);
    return found == costs.end() ? nullptr : &*found;
}

std::string profile_text(const QualityProfile& profile) {
    Json json{{"format", kFormat}, {"version", kVersion}, {"key", json_of(profile.key)}};
    json["costs"] = Json::array();
    for (const PrecisionCost& cost : profile.costs)
        json["costs"].push_back({{"precision", show_word(cost.precision, kPrecisionWords)},
                                 {"engine", cost.engine},
                                 {"encode_ms", cost.encode_ms},
                                 {"first_ms", cost.first_ms},
                                 {"full_ms", cost.full_ms},
                                 {"half_ms", cost.half_ms},
                                 {"third_ms", cost.third_ms}});
    return json_text(json) + "\n";
}

QualityProfile parse_profile(const std::string& text, const ProfileKey& key) {
    const Json json = parse_shallow_json<Json>(text);
    if (json.is_discarded()) refuse("JSON", "something else");
    if (member(json, "format") != kFormat) refuse(kFormat, json.at("format").dump());
    if (member(json, "version") != kVersion)
        refuse("version " + std::to_string(kVersion), json.at("version").dump());
    check_key(member(json, "key"), key);
    const Json& costs = member(json, "costs");
    if (!costs.is_array() || costs.empty()) refuse("a list of costs", costs.dump());
    QualityProfile profile{key, {}};
    for (const Json& cost : costs) profile.costs.push_back(precision_cost(cost));
    return profile;
}

}  // namespace eventide::app
