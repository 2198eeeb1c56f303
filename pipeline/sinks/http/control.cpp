#include "pipeline/sinks/http/control.h"

#include "src/core/error.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace eventide {

namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void refuse(const std::string& words) {
    throw Error(ErrorKind::usage, words);
}

/// What others wrote, in letters that do no harm.
std::string quoted(const std::string& text) {
    return Json(text.substr(0, 40)).dump(-1, ' ', true, Json::error_handler_t::replace);
}

std::string number_text(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", value);
    return text;
}

double value_of(const HttpControl& control, const Json& json) {
    const std::string expected = control.name + ": expected a number from " +
                                 number_text(control.least) + " to " + number_text(control.most);
    if (!json.is_number() && !json.is_boolean()) refuse(expected);
    const double value = json.is_boolean() ? double(json.get<bool>()) : json.get<double>();
    if (!(value >= control.least && value <= control.most))
        refuse(expected + ", found " + number_text(value));
    const double steps = std::round((value - control.least) / control.step);
    return std::clamp(control.least + steps * control.step, control.least, control.most);
}

}  // namespace

std::vector<ControlChange> parse_changes(std::string_view body,
                                         const std::vector<HttpControl>& controls) {
    if (body.size() > kMaxControlBytes) refuse("the request is too long");
    const Json json = Json::parse(body, nullptr, false);
    if (!json.is_object()) refuse("expected a JSON object such as {\"fps\": 60}");
    std::vector<ControlChange> changes;
    for (const auto& [name, value] : json.items()) {
        const auto known = std::ranges::find(controls, name, &HttpControl::name);
        if (known == controls.end()) refuse("unknown control " + quoted(name));
        if (!known->set) refuse(known->name + " cannot be changed now: " + known->fixed);
        changes.emplace_back(&*known, value_of(*known, value));
    }
    return changes;
}

std::string controls_json(const std::vector<HttpControl>& controls) {
    Json list = Json::array();
    for (const HttpControl& control : controls) {
        Json json{{"name", control.name},   {"label", control.label}, {"unit", control.unit},
                  {"least", control.least}, {"most", control.most},   {"step", control.step}};
        json["value"] = control.get ? Json(control.get()) : Json(nullptr);
        json["changeable"] = bool(control.set);
        if (!control.fixed.empty()) json["fixed"] = control.fixed;
        if (!control.text.empty()) json["text"] = control.text;
        list.push_back(std::move(json));
    }
    return list.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace eventide
