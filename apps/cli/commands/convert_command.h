// eventide convert: a recording in another format.
#pragma once

#include "apps/cli/command.h"
#include "apps/cli/settings/input_settings.h"
#include "apps/cli/settings/time_point.h"
#include "pipeline/filters/filter_chain.h"
#include "replay/convert.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace eventide::app {

class ConvertCommand : public Command {
public:
    std::string name() const override { return "convert"; }
    std::string summary() const override { return "Write a recording in another format"; }
    std::string examples() const override;
    std::vector<Positional> positionals() override;
    SettingTable settings() override;
    int run(Program& program) override;

private:
    bool to_udp() const { return to_file_.starts_with("udp:"); }
    const Format* format_to_write() const;
    void name_all_files(const Format* format, NamedFiles& files) const;
    ConvertOptions limits(const TimePointReader& times) const;
    StreamHeader header_behind(const FilterChain& filters, const Format* format,
                               const SensorInfo& sensor) const;
    std::unique_ptr<ConvertTarget> open_target(const Format* format, const StreamHeader& header,
                                               const Program& program) const;
    ConvertReport copy(Recording& recording, ConvertTarget& target, const ConvertOptions& how,
                       bool keeps_earlier, const Program& program) const;

    std::string from_file_, to_file_, to_format_ = "auto";
    InputSettings input_;
    std::optional<TimePoint> from_, to_;
    std::vector<std::string> filter_;
    bool overwrite_ = false, force_ = false, strict_ = false;
};

}  // namespace eventide::app
