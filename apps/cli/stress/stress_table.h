// The table of what stress cases came to, for people and as JSON.
#pragma once

#include "apps/cli/stress/stress_case.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdio>
#include <string>
#include <vector>

namespace eventide::app {

/// One line of the table.
struct StressRow {
    std::string name, title, model;  ///< model is "-" for cases that have none
    stress::Result result;
    double seconds = 0;
};

void print_stress_head(std::FILE* to);
/// Also a row of a table in Markdown.
void print_stress_row(const StressRow& row, std::FILE* to);

nlohmann::ordered_json stress_json(const std::vector<StressRow>& rows);

}  // namespace eventide::app
