#include "apps/train/first_weights.h"

#include "apps/train/network/warm_start.h"
#include "src/core/error.h"

namespace eventide {

Parameters first_weights(const TrainOptions& options, torch::Device device, const LogSink& say) {
    Parameters parameters = initial_parameters(options.model, options.data.seed, device);
    if (options.initial.empty()) return parameters;
    std::string left;
    for (const std::string& name : warm_start(options.initial, parameters)) left += " " + name;
    say("initial weights of " + options.initial + ", new:" + (left.empty() ? " none" : left));
    return parameters;
}

void choose_what_learns(const std::vector<std::string>& prefixes, Parameters& parameters) {
    if (prefixes.empty()) return;
    for (auto& [name, values] : parameters) values.set_requires_grad(false);
    for (const std::string& prefix : prefixes) {
        bool any = false;
        for (auto& [name, values] : parameters) {
            if (prefix.empty() || !name.starts_with(prefix)) continue;
            values.set_requires_grad(true);
            any = true;
        }
        if (!any)
            throw Error(ErrorKind::usage,
                        "--train-only: expected beginnings of names of weights, as " +
                            parameters.begin()->first + ", found '" + prefix + "'");
    }
}

}  // namespace eventide
