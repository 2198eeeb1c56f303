#include "apps/train/checkpoint.h"

#include "src/core/error.h"
#include "src/core/number_text.h"

#include <charconv>

namespace eventide {
namespace {

void put(TensorFile& file, const std::string& prefix, const Parameters& parameters, bool bf16) {
    for (const auto& [name, values] : parameters) {
        Tensor& tensor = file.tensors[prefix + name] = to_tensor(values);
        tensor.bf16 = bf16;
    }
}

const Tensor& tensor_of(const TensorFile& file, const std::string& path, const std::string& name) {
    const auto found = file.tensors.find(name);
    if (found == file.tensors.end())
        throw Error(ErrorKind::input, path + ": expected tensor '" + name + "', found none");
    return found->second;
}

void take(const TensorFile& file, const std::string& path, const std::string& prefix,
          Parameters& into) {
    const torch::NoGradGuard none;
    for (auto& [name, values] : into) {
        const Tensor& tensor = tensor_of(file, path, prefix + name);
        if (tensor.shape != values.sizes().vec())
            throw Error(ErrorKind::input, path + ": tensor '" + prefix + name +
                                              "': expected shape " + shape_text(values.sizes()) +
                                              ", found " + shape_text(tensor.shape));
        values.copy_(to_torch(tensor, values.device()));
    }
}

/// Hexadecimal floats are exact.
std::string exact(double value) {
    char text[40];
    const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::hex).ptr;
    return {text, end};
}

double number(const TensorFile& file, const std::string& path, const char* key) {
    const auto found = file.metadata.find(key);
    if (found == file.metadata.end())
        throw Error(ErrorKind::input, path + ": expected metadata '" + key + "', found none");
    const std::string& text = found->second;
    const auto value = hex_number_in<double>(text);
    if (!value)
        throw Error(ErrorKind::input, path + ": metadata '" + std::string{key} +
                                          "': expected a number, found '" + text + "'");
    return *value;
}

void put_states(TensorFile& file, const std::string& prefix,
                const std::vector<RecurrentState>& states) {
    for (std::size_t i = 0; i < states.size(); ++i) {
        const std::string name = prefix + std::to_string(i) + ".";
        file.tensors[name + "latent"] = to_tensor(states[i].latent);
        for (std::size_t l = 0; l < states[i].state.size(); ++l)
            file.tensors[name + "state." + std::to_string(l)] = to_tensor(states[i].state[l]);
    }
}

std::vector<RecurrentState> take_states(const TensorFile& file, const std::string& path,
                                        const std::string& prefix, std::size_t count,
                                        torch::Device device) {
    std::vector<RecurrentState> states(count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::string name = prefix + std::to_string(i) + ".";
        const auto map = [&](const std::string& part) {
            return to_torch(tensor_of(file, path, name + part), device)
                .contiguous(torch::MemoryFormat::ChannelsLast);
        };
        states[i].latent = map("latent");
        for (int l = 0; file.tensors.count(name + "state." + std::to_string(l)) != 0; ++l)
            states[i].state.push_back(map("state." + std::to_string(l)));
    }
    return states;
}

}  // namespace

void save_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint,
                     const Optimiser& optimiser) {
    TensorFile file;
    file.metadata = {{"format", "eventide-checkpoint"},
                     {"window", exact(double(checkpoint.segment))},
                     {"steps", exact(double(optimiser.steps))},
                     {"elapsed_minutes", exact(checkpoint.elapsed_minutes)},
                     {"best_score", exact(checkpoint.best_score)},
                     {"threads", exact(double(checkpoint.recurrent_states.size()))},
                     {"teacher_states", exact(double(checkpoint.teacher_states.size()))},
                     {"options", checkpoint.options}};
    // A run that stops and goes on is one that did not stop; one that is kept without its states is
    // not, and of means of gradients, which are mostly noise, 1/256 is enough.
    const bool small_moments = checkpoint.recurrent_states.empty();
    put(file, "weights.", optimiser.parameters, false);
    put(file, "moment1.", optimiser.moment1, small_moments);
    put(file, "moment2.", optimiser.moment2, small_moments);
    put(file, "ema.", optimiser.ema, false);
    put_states(file, "recurrent.", checkpoint.recurrent_states);
    put_states(file, "teacher.", checkpoint.teacher_states);
    write_safetensors(path, file);
}

bool is_checkpoint(const TensorFile& file) {
    const auto format = file.metadata.find("format");
    return format != file.metadata.end() && format->second == "eventide-checkpoint";
}

std::string checkpoint_options(const std::filesystem::path& path) {
    const TensorFile file = read_safetensors(path);
    const auto options = file.metadata.find("options");
    if (!is_checkpoint(file) || options == file.metadata.end())
        throw Error(ErrorKind::input, path.string() + ": expected a checkpoint of training");
    return options->second;
}

Checkpoint load_checkpoint(const std::filesystem::path& path, Optimiser& optimiser) {
    const TensorFile file = read_safetensors(path);
    const std::string name = path.string();
    Checkpoint checkpoint;
    checkpoint.options = checkpoint_options(path);
    checkpoint.segment = std::int64_t(number(file, name, "window"));
    checkpoint.elapsed_minutes = number(file, name, "elapsed_minutes");
    checkpoint.best_score = number(file, name, "best_score");
    optimiser.steps = std::int64_t(number(file, name, "steps"));
    take(file, name, "weights.", optimiser.parameters);
    take(file, name, "moment1.", optimiser.moment1);
    take(file, name, "moment2.", optimiser.moment2);
    take(file, name, "ema.", optimiser.ema);
    const torch::Device device = optimiser.parameters.begin()->second.device();
    const auto count = [&](const char* key) { return std::size_t(number(file, name, key)); };
    checkpoint.recurrent_states = take_states(file, name, "recurrent.", count("threads"), device);
    if (file.metadata.contains("teacher_states"))
        checkpoint.teacher_states =
            take_states(file, name, "teacher.", count("teacher_states"), device);
    return checkpoint;
}

}  // namespace eventide
