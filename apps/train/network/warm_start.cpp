#include "apps/train/network/warm_start.h"

#include "apps/train/checkpoint.h"
#include "src/core/error.h"

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

}  // namespace

std::vector<std::string> warm_start(const std::filesystem::path& path, Parameters& parameters) {
    const TensorFile file = read_safetensors(path);
    const std::string prefix = is_checkpoint(file) ? "ema." : "";
    const torch::NoGradGuard none;
    std::vector<std::string> left;
    bool related = false;  // biases agree by chance: the renderer's last has two numbers always
    for (auto& [name, values] : parameters) {
        const auto found = file.tensors.find(prefix + name);
        if (found != file.tensors.end() && found->second.shape == values.sizes().vec()) {
            values.copy_(to_torch(found->second, values.device()));
            related |= name.ends_with(".weight");
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
