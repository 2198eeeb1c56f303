// Keys and values of a simulated source's name.
#include "drivers/simulated/simulated_name.h"

#include "src/core/error.h"
#include "src/core/number_text.h"

#include <optional>
#include <utility>

namespace eventide {

namespace {

[[noreturn]] void refuse(std::string_view key, std::string_view expected, std::string_view found) {
    throw Error(ErrorKind::usage, "simulated source, " + std::string(key) + ": expected " +
                                      std::string(expected) + ", found '" + std::string(found) +
                                      "'");
}

template <typename Number>
Number number(std::string_view key, std::string_view text) {
    const auto value = number_in<Number>(text);
    if (!value) refuse(key, "a number", text);
    return *value;
}

std::pair<std::string_view, std::optional<std::string_view>> split(std::string_view text, char at) {
    const auto place = text.find(at);
    if (place == text.npos) return {text, {}};
    return {text.substr(0, place), text.substr(place + 1)};
}

void set(SimulatedSourceSettings& s, std::string_view key, std::string_view value) {
    if (key == "seed") {
        s.recording.seed = number<std::uint64_t>(key, value);
    } else if (key == "size") {
        const auto [width, height] = split(value, 'x');
        if (!height) refuse(key, "WxH", value);
        s.recording.width = number<int>(key, width);
        s.recording.height = number<int>(key, *height);
    } else if (key == "images") {
        s.recording.images_per_second = number<double>(key, value);
    } else if (key == "seconds") {
        s.recording.seconds = number<double>(key, value);
        if (!(s.recording.seconds >= 0.001)) refuse(key, "a number from 0.001 up", value);
    } else if (key == "speed") {
        s.speed = value == "max" ? 0 : number<double>(key, value);
        if (value != "max" && !(s.speed >= 0.001 && s.speed <= 1000))
            refuse(key, "a number from 0.001 to 1000, or max", value);
    } else if (key == "textures") {
        s.textures = value;
    } else {
        refuse("key", "seed, size, images, seconds, speed or textures", key);
    }
}

}  // namespace

bool names_simulation(std::string_view source) {
    return source.starts_with(kSimulatedScheme);
}

SimulatedSourceSettings parse_simulated_name(std::string_view source) {
    if (!names_simulation(source)) refuse("name", "sim:SCENE", source);
    SimulatedSourceSettings settings;
    const auto [scene, keys] = split(source.substr(kSimulatedScheme.size()), '?');
    if (!scene.empty()) settings.scene = scene;
    const SimulationPreset& preset = simulation_preset(settings.scene);
    settings.recording.scene = preset.scene;
    settings.recording.sensor = preset.sensor;
    settings.recording.seed = preset.seed;
    settings.recording.seconds = 0;
    for (auto rest = keys; rest;) {
        const auto [item, more] = split(*rest, '&');
        const auto [key, value] = split(item, '=');
        if (!value) refuse("key", "KEY=VALUE", item);
        set(settings, key, *value);
        rest = more;
    }
    constexpr double kSecondsAtMost = 4;  // what is not live must end
    if (settings.speed == 0 && settings.recording.seconds == 0)
        settings.recording.seconds = kSecondsAtMost;
    return settings;
}

}  // namespace eventide
