// Shares of what was read.
#include "replay/left_out.h"

#include "src/core/damage_text.h"
#include "src/core/number_text.h"
#include "src/io/stream_name.h"

#include <cstdio>

namespace eventide {

namespace {

std::string share_text(std::uint64_t part, std::uint64_t of) {
    const double percent = 100 * double(part) / double(of);
    char share[32];
    std::snprintf(share, sizeof share, percent < 10 ? "%.2g %%" : "%.0f %%", percent);
    return share;
}

/// Of what was set right nothing is missing.
bool is_left_out(DamageReason reason) {
    return reason != DamageReason::bad_table && reason != DamageReason::time_corrected;
}

std::string what_to_do(DamageReason reason, const std::string& format) {
    if (reason == DamageReason::truncated) return {};  // nothing brings back what is not there
    const bool is_text = format == "text";
    if (reason == DamageReason::time_backwards)
        return is_text ? "; a larger --reorder puts them in order, sorting the file does, too"
               : format == "npy" || format == "npz" ? "; sorting them by time puts them in order"
                                                    : "";
    if (reason == DamageReason::out_of_range)
        return std::string{"; --input-size states the sensor's size"} +
               (is_text ? ", --input-columns the order of the columns" : "");
    return is_text ? "; --input-columns and --input-time-unit state how the rows are meant"
                   : "; --input-format states another format";
}

/// Where more records were left out than events were taken.
std::string most_left_out(const std::string& name, const std::string& format, std::uint64_t events,
                          const Damage& damaged) {
    Damage left_out;
    auto most = DamageReason::truncated;
    for (std::size_t i = 0; i < kDamageReasons; ++i) {
        const auto reason = DamageReason(i);
        if (!is_left_out(reason)) continue;
        left_out.count(reason, damaged[reason]);
        if (damaged[reason] > damaged[most]) most = reason;
    }
    const std::uint64_t lost = left_out.total();
    if (lost <= events) return {};
    return name + ": " + share_text(lost, events + lost) +
           " of it was left out as damaged: " + damage_text(left_out) + what_to_do(most, format);
}

}  // namespace

std::string left_out_text(const std::string& path, const std::string& format, std::uint64_t events,
                          const Damage& damaged) {
    const std::string name = input_name(path);
    if (std::string most = most_left_out(name, format, events, damaged); !most.empty()) return most;
    const std::uint64_t late = damaged[DamageReason::time_backwards];
    if (late == 0) return {};
    return name + ": " + counted(late, "event") + " (" + share_text(late, events + late) +
           ") left out, their times lie before those of events already read" +
           what_to_do(DamageReason::time_backwards, format);
}

}  // namespace eventide
