// The command line of eventide-train: one table that is parsed, printed as help, and recorded.
#pragma once

#include "apps/train/data/data_loader.h"
#include "apps/train/network/losses.h"
#include "apps/train/network/parameters.h"
#include "apps/train/optimiser.h"
#include "src/core/arithmetic_words.h"
#include "src/model/model_config.h"
#include "src/settings/setting.h"

#include <map>
#include <string>
#include <vector>

namespace eventide {

struct TrainOptions {
    ModelConfig model;
    std::vector<std::string> inputs{kGridInputs.begin(), kGridInputs.end()};
    DataSettings data;
    LossWeights loss;
    OptimiserSettings optimiser;
    std::string out = "out/train";
    std::string textures, validation_textures, lpips;
    std::string resume, initial, export_file, keep, card;
    bool overwrite = false;  ///< of export_file and keep
    std::string teacher;     ///< model whose frames mu learns from, beside the truth; empty: none
    double teacher_share = .8;  ///< of them in what mu is drawn to; the rest is the truth
    int teacher_views = 2;
    std::vector<std::string> train_only;  ///< beginnings of names of weights that learn; empty: all
    std::string device = "cpu";
    Precision precision = Precision::automatic;  ///< of activations
    double minutes = 60;
    std::string clock = "wall";   ///< that minutes go by: wall, or cpu
    int steps = 0;                ///< where not 0, the budget instead of `minutes`
    int lpips_frames = 1 << 20;   ///< of the rendered ones, the last, that LPIPS looks at
    bool lpips_on_pixels = true;  ///< LPIPS looks also at patches whose points are pixels
    int threads = 1, streams = 2, groups = 4;
    double learning_rate = 1e-3, final_rate = 0.02, constant_share = 0.6;
    int warm_up = 100;
    double checkpoint_minutes = 3, validate_minutes = 5;
    int log_every = 25;
    int validation_scenes = 12, validation_windows = 40, validation_crop = 96;
};

/// Words and their meaning: "--name value".
class OptionTable {
public:
    explicit OptionTable(TrainOptions& options);

    /// Throws Error(usage) naming the word, what was expected and what was found.
    void parse(const std::vector<std::string>& words);
    void set(const std::string& name, const std::string& value);

    std::string help() const;
    /// "--name value", one per line: all that a resumed run has to know.
    std::string record() const;

    /// "--name value" in one line: all that decides what is learned, without names of files.
    std::string settings() const;

private:
    /// What a value decides: what is learned; where things lie and for how long; one call only.
    enum class Use { learning, run, once };
    struct Option {
        Setting setting;
        Use use;
        std::string value() const { return setting.show().front(); }
    };

    template <typename T>
    void add(const std::string& name, T& target, const std::string& help, Use use = Use::learning);
    template <typename Enum>
    void add_choice(const std::string& name, Enum& target, const std::string& help,
                    const std::vector<Word<Enum>>& words);
    void add_run_options(TrainOptions& o);
    void add_network_options(TrainOptions& o);
    void add_data_options(TrainOptions& o);
    void add_scene_options(TrainOptions& o);
    void add_sensor_options(TrainOptions& o);
    void add_loss_options(TrainOptions& o);
    void add_schedule_options(TrainOptions& o);

    std::vector<Option> options_;
};

}  // namespace eventide
