// eventide simulate: recordings whose truth is known.
#pragma once

#include "apps/cli/command.h"
#include "apps/cli/commands/recording_out.h"
#include "pipeline/sinks/folder.h"
#include "src/core/frame_data.h"
#include "src/settings/values.h"
#include "src/simulate/colour_recording.h"

#include <functional>
#include <optional>
#include <vector>

namespace eventide::app {

class SimulateCommand : public Command {
public:
    std::string name() const override { return "simulate"; }
    std::string summary() const override {
        return "Simulate a camera before a moving scene: events, images, truth";
    }
    std::string examples() const override;
    SettingTable settings() override;
    int run(Program& program) override;

private:
    SimRecordingSettings plan() const;
    /// Emits as simulate_recording() does; of a grey camera the first textures are used.
    void simulate(const SimRecordingSettings& what, const ColourRecording::Textures& textures,
                  const std::function<bool(const Batch&, std::vector<Frame>&)>& emit) const;
    struct Written {
        std::uint64_t events = 0, images = 0, truths = 0;
    };
    Written write(const SimRecordingSettings& what, const ColourRecording::Textures& textures,
                  RecordingOut& out, FolderSink* truth, const std::function<bool()>& goes_on,
                  bool quiet) const;
    void refuse_what_would_change_nothing(const Program& program) const;
    void name_output_files(NamedFiles& files) const;
    ColourRecording::Textures textures() const;
    void warn_of_loss(const FormatHolds& holds) const;

    std::string scene_ = "demo", out_, truth_, textures_;
    std::string seed_ = "auto";
    ColourFilter bayer_ = ColourFilter::none;
    Size size_{240, 180};
    std::optional<double> lux_, speed_, lamp_;
    double seconds_ = 4, images_per_second_ = 25, truths_per_second_ = 25, truth_scale_ = 1;
    bool overwrite_ = false, list_ = false;
};

}  // namespace eventide::app
