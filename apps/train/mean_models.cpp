// eventide-mean-models: the mean of models with the same options as a model.
#include "apps/train/contrast.h"
#include "apps/train/mean_of_models.h"
#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/io/output_file.h"

#include <iostream>
#include <string>
#include <vector>

namespace {

using namespace eventide;

constexpr const char* kUsage =
    "eventide-mean-models OUT CARD (MODEL WEIGHT)... [--contrast GAIN AROUND]\n"
    "The mean of models with the same options, by weights that add up to 1; CARD is what the new\n"
    "model's card says. --contrast: its frames become AROUND + GAIN (intensity - AROUND).\n";

double number(const std::string& text) {
    const auto value = number_in<double>(text);
    if (!value) throw Error(ErrorKind::usage, "expected a number, found '" + text + "'");
    return *value;
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<std::string> words(argv + 1, argv + argc);
    std::vector<std::string> contrast;
    if (words.size() > 3 && words[words.size() - 3] == "--contrast") {
        contrast.assign(words.end() - 2, words.end());
        words.resize(words.size() - 3);
    }
    if (words.size() < 4 || words.size() % 2 != 0) {
        std::cerr << kUsage;
        return int(ErrorKind::usage);
    }
    try {
        refuse_existing(words[0], false);
        std::vector<WeightedModel> models;
        for (std::size_t i = 2; i < words.size(); i += 2)
            models.push_back({load_model(words[i]), number(words[i + 1])});
        Model mean = mean_of(models);
        mean.config.card = words[1];
        if (!contrast.empty()) stretch_contrast(mean, number(contrast[0]), number(contrast[1]));
        save_model(words[0], mean, false);
    } catch (const Error& error) {
        std::cerr << "eventide-mean-models: " << error.what() << "\n";
        return int(error.kind());
    }
    return 0;
}
