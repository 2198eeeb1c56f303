// What bench_peers measured, for the report.
#include "apps/cli/bench/report.h"
#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/io/input_file.h"

#include <sstream>

namespace eventide::app {

namespace {

constexpr std::size_t kColumns = 8;

template <typename T>
bool read_number(const std::string& text, T& value) {
    value = number_in<T>(text).value_or(T{});
    return value > 0;
}

bool read_row(const std::string& line, PeerRow& row) {
    std::vector<std::string> cells;
    std::istringstream stream{line};
    for (std::string cell; std::getline(stream, cell, '\t');) cells.push_back(cell);
    if (cells.size() != kColumns) return false;
    row.network = cells[0];
    row.engine = cells[1];
    row.instructions = cells[2];
    return read_number(cells[3], row.sensor.width) && read_number(cells[4], row.sensor.height) &&
           read_number(cells[5], row.threads) && read_number(cells[7], row.wall_ms);
}

}  // namespace

std::vector<PeerRow> read_peers(const std::filesystem::path& file) {
    std::vector<PeerRow> rows;
    if (file.empty()) return rows;
    std::istringstream in{read_text_file(file)};
    std::string line;
    if (!std::getline(in, line))
        throw Error(ErrorKind::input, file.string() + ": expected a table, found an empty file");
    for (int number = 2; std::getline(in, line); ++number)
        if (!read_row(line, rows.emplace_back()))
            throw Error(
                ErrorKind::input,
                file.string() + ":" + std::to_string(number) +
                    ": expected a row of bench_peers --table (network, engine, instructions, "
                    "width, height, threads, cpu_ms, wall_ms), found something else");
    return rows;
}

}  // namespace eventide::app
