// The table of what stress cases came to, for people and as JSON.
#include "apps/cli/stress/stress_table.h"

#include "apps/cli/printable.h"
#include "apps/cli/version.h"

#include <nlohmann/json.hpp>

#include <optional>

namespace eventide::app {

namespace {

const char* verdict(const stress::Result& result) {
    if (!result.ran) return "not run";
    return result.passed ? "passed" : "FAILED";
}

std::string number_or_dash(const std::optional<double>& number) {
    return number ? stress::short_number(*number) : "-";
}

}  // namespace

void print_stress_head(std::FILE* to) {
    std::fputs(
        "| case | model | what happened | worst error | bound | verdict |\n"
        "|---|---|---|---|---|---|\n",
        to);
}

void print_stress_row(const StressRow& row, std::FILE* to) {
    std::fprintf(to, "| %s | %s | %s | %s | %s | %s |\n", row.title.c_str(),
                 printable(row.model).c_str(), printable(row.result.happened).c_str(),
                 number_or_dash(row.result.error).c_str(), number_or_dash(row.result.bound).c_str(),
                 verdict(row.result));
    std::fflush(to);
}

nlohmann::ordered_json stress_json(const std::vector<StressRow>& rows) {
    nlohmann::ordered_json json;
    json["machine"] = processor_text();
    json["program"] = "eventide " + version() + ", " + compiler_text();
    json["rows"] = nlohmann::ordered_json::array();
    for (const StressRow& row : rows) {
        nlohmann::ordered_json one{{"case", row.name},
                                   {"title", row.title},
                                   {"model", row.model},
                                   {"happened", row.result.happened},
                                   {"verdict", verdict(row.result)},
                                   {"seconds", row.seconds}};
        if (row.result.error) one["worst_error"] = *row.result.error;
        if (row.result.bound) one["bound"] = *row.result.bound;
        json["rows"].push_back(std::move(one));
    }
    return json;
}

}  // namespace eventide::app
