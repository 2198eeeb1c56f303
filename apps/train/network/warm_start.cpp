#include "apps/train/network/warm_start.h"

#include "apps/train/checkpoint.h"
#include "src/core/error.h"

#include <algorithm>

namespace eventide {
namespace {

/// The weights of a join are [out][the level below, doubled | the level's own][3][3].
bool is_join(const std::string& name) {
    return name.starts_with("encoder.up.") && name.ends_with(".weight");
}

/// Its own level as it is, and a little of the one below.
void let_through(torch::Tensor& join) {
    const std::int64_t width = join.size(0), below = join.size(1) - width;
    join *= 0.1;
    for (std::int64_t c = 0; c < width && below >= 0; ++c) join[c][below + c][1][1] += 1;
}

/// A run of channels of the network that was learned from, and where a wider one has it.
struct Run {
    std::int64_t from, to, channels;
};

/// Of a dimension whose last `last` channels are a part of their own ([a | h], [u | r]).
std::vector<Run> runs(std::int64_t narrow, std::int64_t narrow_last, std::int64_t wide,
                      std::int64_t wide_last) {
    return {{0, 0, narrow - narrow_last}, {narrow - narrow_last, wide - wide_last, narrow_last}};
}

/// The learned channels as they were, which hear nothing of the new ones; those begin at random.
void widen(const std::string& name, const torch::Tensor& narrow, torch::Tensor& wide) {
    const bool two_gates = name.find(".gates.") != std::string::npos;
    const auto outputs = runs(narrow.size(0), two_gates ? narrow.size(0) / 2 : 0, wide.size(0),
                              two_gates ? wide.size(0) / 2 : 0);
    if (narrow.dim() == 1) {
        for (const Run& o : outputs)
            wide.narrow(0, o.to, o.channels).copy_(narrow.narrow(0, o.from, o.channels));
        return;
    }
    const bool with_state = name.find(".gru.") != std::string::npos, join = is_join(name);
    const auto last = [&](const torch::Tensor& weights) {
        return join ? weights.size(0) : with_state ? weights.size(1) / 2 : 0;
    };
    const auto inputs = runs(narrow.size(1), last(narrow), wide.size(1), last(wide));
    for (const Run& o : outputs) {
        wide.narrow(0, o.to, o.channels).zero_();
        for (const Run& i : inputs)
            wide.narrow(0, o.to, o.channels)
                .narrow(1, i.to, i.channels)
                .copy_(narrow.narrow(0, o.from, o.channels).narrow(1, i.from, i.channels));
    }
}

bool fits_into(const Tensor& narrow, const torch::Tensor& wide) {
    const auto sizes = wide.sizes().vec();
    if (narrow.shape.size() != sizes.size()) return false;
    for (std::size_t d = 0; d < sizes.size(); ++d)
        if (narrow.shape[d] > sizes[d] || (d > 1 && narrow.shape[d] != sizes[d])) return false;
    return true;
}

/// Every layer of the encoder is there and none is wider than the one asked for.
bool is_narrower(const TensorFile& file, const std::string& prefix, const Parameters& parameters) {
    return std::all_of(parameters.begin(), parameters.end(), [&](const auto& parameter) {
        if (!parameter.first.starts_with("encoder.")) return true;
        const auto found = file.tensors.find(prefix + parameter.first);
        return found != file.tensors.end() && fits_into(found->second, parameter.second);
    });
}

}  // namespace

std::vector<std::string> warm_start(const std::filesystem::path& path, Parameters& parameters) {
    const TensorFile file = read_safetensors(path);
    const std::string prefix = is_checkpoint(file) ? "ema." : "";
    const torch::NoGradGuard none;
    std::vector<std::string> left;
    const bool widens = is_narrower(file, prefix, parameters);
    bool related = false;  // biases agree by chance: the renderer's last has two numbers always
    for (auto& [name, values] : parameters) {
        const auto found = file.tensors.find(prefix + name);
        if (found != file.tensors.end() && found->second.shape == values.sizes().vec()) {
            values.copy_(to_torch(found->second, values.device()));
            related |= name.ends_with(".weight");
        } else if (widens && name.starts_with("encoder.")) {
            widen(name, to_torch(found->second, values.device()), values);
        } else {
            if (is_join(name)) let_through(values);
            left.push_back(name);
        }
    }
    if (!related)
        throw Error(ErrorKind::input,
                    path.string() +
                        ": expected weights of a network like the one asked for, found none of the "
                        "same name and shape");
    return left;
}

}  // namespace eventide
