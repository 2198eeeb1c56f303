// One table says which keys there are, how each is written, and what it may be.
#include "src/model/model_metadata.h"

#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/core/sensor_limits.h"
#include "src/core/words.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <vector>

namespace eventide {
namespace {

[[noreturn]] void refuse(const std::string& file, const std::string& key,
                         const std::string& expected, const std::string& found) {
    throw Error(ErrorKind::input, file + ": metadata '" + key + "': expected " + expected +
                                      ", found '" + found + "'");
}

template <typename T>
bool read_into(const std::string& text, T& value) {
    const auto found = number_in<T>(text);
    value = found.value_or(value);
    return found.has_value();
}

bool parse_list(const std::string& text, std::vector<int>& values) {
    values.clear();
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t comma = std::min(text.find(',', at), text.size());
        const auto value = number_in<int>(std::string_view{text}.substr(at, comma - at));
        if (!value) return false;
        values.push_back(*value);
        at = comma + 1;
    }
    return true;
}

std::string list_text(const std::vector<int>& values) {
    std::string text;
    for (const int value : values) text += (text.empty() ? "" : ",") + std::to_string(value);
    return text;
}

std::string number_text(float value) {
    std::array<char, 32> buffer{};
    return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr};
}

struct Key {
    std::string name, expected;
    std::function<std::string(const ModelConfig&)> format;
    std::function<bool(const std::string&, ModelConfig&)> parse;
    bool may_be_missing = false;  // where files of before have not got it
};

Key optional(Key key) {
    key.may_be_missing = true;
    return key;
}

Key whole_number(const char* name, int ModelConfig::*member) {
    return {name, "a whole number",
            [=](const ModelConfig& config) { return std::to_string(config.*member); },
            [=](const std::string& text, ModelConfig& config) {
                return read_into(text, config.*member);
            }};
}

Key number(const char* name, float ModelConfig::*member) {
    return {name, "a finite number",
            [=](const ModelConfig& config) { return number_text(config.*member); },
            [=](const std::string& text, ModelConfig& config) {
                return read_into(text, config.*member);
            }};
}

Key list(const char* name, std::vector<int> ModelConfig::*member) {
    return {name, "whole numbers with commas",
            [=](const ModelConfig& config) { return list_text(config.*member); },
            [=](const std::string& text, ModelConfig& config) {
                return parse_list(text, config.*member);
            }};
}

Key text(const char* name, std::string ModelConfig::*member) {
    return {name, "text", [=](const ModelConfig& config) { return config.*member; },
            [=](const std::string& value, ModelConfig& config) {
                config.*member = value;
                return true;
            }};
}

Key constant(const char* name, const char* value) {
    return {name, value, [=](const ModelConfig&) { return std::string{value}; },
            [=](const std::string& found, ModelConfig&) { return found == value; }};
}

/// One of a few words.
template <typename Enum>
Key choice(const char* name, Enum ModelConfig::*member, const std::vector<Word<Enum>>& words) {
    return {name, alternatives(texts_of(words)),
            [=](const ModelConfig& config) { return show_word(config.*member, words); },
            [=](const std::string& text, ModelConfig& config) {
                const auto value = find_word(text, words);
                if (value) config.*member = *value;
                return value.has_value();
            }};
}

Key flag(const char* name, bool ModelConfig::*member) {
    return choice(name, member, {{false, "0"}, {true, "1"}});
}

const std::vector<Key>& keys() {
    static const std::vector<Key> kKeys{
        constant("format", "eventide-model"),
        constant("version", "1"),
        choice("encoder", &ModelConfig::encoder,
               {{EncoderKind::gated, "gated"}, {EncoderKind::thesis, "thesis"}}),
        whole_number("bins", &ModelConfig::bins),
        list("widths", &ModelConfig::widths),
        list("recurrent", &ModelConfig::recurrent),
        optional(flag("reset_gate", &ModelConfig::reset_gate)),
        whole_number("res_blocks", &ModelConfig::res_blocks),
        whole_number("gate_radius", &ModelConfig::gate_radius),
        optional(whole_number("gate_spread", &ModelConfig::gate_spread)),
        optional(flag("out_layer", &ModelConfig::out_layer)),
        whole_number("latent", &ModelConfig::latent),
        whole_number("latent_stride", &ModelConfig::latent_stride),
        optional(whole_number("unfold", &ModelConfig::unfold)),
        list("mlp", &ModelConfig::mlp),
        list("lookaheads", &ModelConfig::lookaheads),
        number("log_sigma_min", &ModelConfig::log_sigma_min),
        number("log_sigma_max", &ModelConfig::log_sigma_max),
        number("sigma_scale", &ModelConfig::sigma_scale),
        choice("sigma_rule", &ModelConfig::sigma_rule,
               {{SigmaRule::log_blend, "log_blend"}, {SigmaRule::mixture, "mixture"}}),
        optional(choice("blend", &ModelConfig::blend,
                        {{Blend::linear, "linear"}, {Blend::smooth, "smooth"}})),
        optional(choice("live_edge", &ModelConfig::live_edge,
                        {{LiveEdge::jump, "jump"}, {LiveEdge::fade, "fade"}})),
        optional(
            choice("noise_filter", &ModelConfig::noise_filter, {{false, "off"}, {true, "auto"}})),
        text("window", &ModelConfig::window),
        text("card", &ModelConfig::card),
    };
    return kKeys;
}

/// Limits far beyond any network that makes sense, so that a damaged file cannot ask for the moon.
constexpr int kMaxWidth = 1024, kMaxLevels = 8, kMaxBins = 64, kMaxLayers = 16, kMaxRadius = 64;

void check_range(const std::string& file, const char* key, int value, int low, int high) {
    if (value < low || value > high)
        refuse(file, key, std::to_string(low) + " to " + std::to_string(high),
               std::to_string(value));
}

void check_list(const std::string& file, const char* key, const std::vector<int>& values,
                int max_length, int low, int high) {
    if (values.empty() || int(values.size()) > max_length)
        refuse(file, key, "1 to " + std::to_string(max_length) + " numbers", list_text(values));
    for (const int value : values) check_range(file, key, value, low, high);
}

}  // namespace

std::map<std::string, std::string> format_metadata(const ModelConfig& config) {
    std::map<std::string, std::string> metadata;
    for (const Key& key : keys()) metadata[key.name] = key.format(config);
    return metadata;
}

ModelConfig parse_metadata(const std::map<std::string, std::string>& metadata,
                           const std::string& file) {
    ModelConfig config;
    for (const Key& key : keys()) {
        const auto found = metadata.find(key.name);
        if (found == metadata.end() && key.may_be_missing) continue;
        if (found == metadata.end())
            throw Error(ErrorKind::input, file + ": metadata '" + key.name +
                                              "' is missing: not a model file of this project");
        if (!key.parse(found->second, config)) refuse(file, key.name, key.expected, found->second);
    }
    for (const auto& [name, value] : metadata) {
        bool known = false;
        for (const Key& key : keys()) known = known || key.name == name;
        if (!known) refuse(file, name, "no such key", value);
    }
    check_config(config, file);
    return config;
}

void check_config(const ModelConfig& config, const std::string& file) {
    check_range(file, "bins", config.bins, 1, kMaxBins);
    check_list(file, "widths", config.widths, kMaxLevels, 1, kMaxWidth);
    check_list(file, "recurrent", config.recurrent, kMaxLevels, 0, 1);
    check_range(file, "res_blocks", config.res_blocks, 0, kMaxLayers);
    check_range(file, "gate_radius", config.gate_radius, 0, kMaxRadius);
    check_range(file, "gate_spread", config.gate_spread, 0, kMaxRadius);
    check_range(file, "latent", config.latent, 1, kMaxWidth);
    check_range(file, "latent_stride", config.latent_stride, 1, 2);
    if (config.unfold != 1 && config.unfold != 3)
        refuse(file, "unfold", "1 or 3", std::to_string(config.unfold));
    check_list(file, "mlp", config.mlp, kMaxLayers, 1, kMaxWidth);
    check_list(file, "lookaheads", config.lookaheads, kMaxLookahead + 1, 0, kMaxLookahead);
    if (config.log_sigma_min > config.log_sigma_max)
        refuse(file, "log_sigma_min", "at most log_sigma_max", number_text(config.log_sigma_min));
    if (!(config.sigma_scale > 0))
        refuse(file, "sigma_scale", "a number above 0", number_text(config.sigma_scale));
    if (config.encoder == EncoderKind::thesis) {
        if (config.levels() != 1)
            refuse(file, "widths", "one width for the thesis encoder", list_text(config.widths));
        if (config.latent_stride != 1)
            refuse(file, "latent_stride", "1 for the thesis encoder", "2");
        if (!config.reset_gate) refuse(file, "reset_gate", "1 for the thesis encoder", "0");
        if (!config.out_layer) refuse(file, "out_layer", "1 for the thesis encoder", "0");
        return;
    }
    if (config.recurrent.size() != config.widths.size())
        refuse(file, "recurrent", std::to_string(config.levels()) + " numbers, as many as widths",
               list_text(config.recurrent));
    if (config.levels() < config.latent_stride)
        refuse(file, "latent_stride", "a level of that resolution in widths", "2");
    // The codes are then the map that levels are joined to, as wide as its level.
    const int last = config.latent_stride - 1;
    if (!config.out_layer &&
        (config.levels() - 1 == last || config.latent != config.widths[std::size_t(last)]))
        refuse(file, "out_layer", "1, or latent as wide as a level that others are joined to", "0");
}

}  // namespace eventide
