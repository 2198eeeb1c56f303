// Model files: the list of tensors a shape asks for, held against what a file has.
#include "src/model/model_file.h"

#include "src/core/error.h"
#include "src/model/model_metadata.h"

#include <cmath>
#include <cstring>

namespace eventide {
namespace {

using Shape = std::vector<std::int64_t>;

/// Collects names and shapes in the order of docs/model.md.
class TensorList {
public:
    void conv(const std::string& name, int out, int in) {
        add(name + ".weight", {out, in, 3, 3});
        add(name + ".bias", {out});
    }
    void linear(const std::string& name, int out, int in) {
        add(name + ".weight", {out, in});
        add(name + ".bias", {out});
    }
    void gru(const std::string& name, int in, int state, bool reset_gate = true) {
        conv(name + ".gates", (reset_gate ? 2 : 1) * state, in + state);
        conv(name + ".candidate", state, in + state);
    }
    void norm(const std::string& name, int channels) {
        for (const char* part : {".alpha", ".gamma", ".beta"}) add(name + part, {channels});
    }
    std::vector<std::pair<std::string, Shape>> take() { return std::move(list_); }

private:
    void add(std::string name, Shape shape) {
        list_.emplace_back(std::move(name), std::move(shape));
    }
    std::vector<std::pair<std::string, Shape>> list_;
};

std::string numbered(const char* name, int i) {
    return "encoder." + std::string{name} + "." + std::to_string(i);
}

/// Of widths 8, 16, 32, 64, 64, 21 input channels and 16 codes: in [8][21][3][3], down.1
/// [16][8][3][3], gru.0.gates [2 x 8][8 + 8][3][3], res.0.0 [64][64][3][3], up.0 [8][16 + 8][3][3],
/// out [16][8][3][3].
void list_gated(const ModelConfig& config, TensorList& list) {
    const auto width = [&](int level) { return config.widths[std::size_t(level)]; };
    const int levels = config.levels(), top = width(levels - 1), last = config.latent_stride - 1;
    list.conv("encoder.in", width(0), config.input_channels());
    for (int l = 1; l < levels; ++l) list.conv(numbered("down", l), width(l), width(l - 1));
    for (int l = 0; l < levels; ++l)
        if (config.recurrent[std::size_t(l)] != 0)
            list.gru(numbered("gru", l), width(l), width(l), config.reset_gate);
    for (int i = 0; i < config.res_blocks; ++i)
        for (const char* half : {".0", ".1"}) list.conv(numbered("res", i) + half, top, top);
    for (int l = levels - 2; l >= last; --l)
        list.conv(numbered("up", l), width(l), width(l + 1) + width(l));
    if (config.out_layer) list.conv("encoder.out", config.latent, width(last));
}

void list_thesis(const ModelConfig& config, TensorList& list) {
    const int c = config.widths[0];
    list.conv("encoder.in", c, config.input_channels());
    for (int i = 0; i < 5; ++i) list.norm("encoder.norm" + std::to_string(i), c);
    for (int i = 0; i < 2; ++i) list.gru(numbered("gru", i), c, c);
    for (int i = 0; i < 2; ++i) list.conv(numbered("res", i), c, c);
    list.conv("encoder.down", c, c);
    list.conv("encoder.head.0", c, 3 * c);
    list.conv("encoder.head.1", c, c);
    list.conv("encoder.head.2", config.latent, c);
}

/// FNV-1a, 64 bit.
class Digest {
public:
    void add(const void* data, std::size_t size) {
        const auto* bytes = static_cast<const unsigned char*>(data);
        for (std::size_t i = 0; i < size; ++i) hash_ = (hash_ ^ bytes[i]) * 0x100000001b3u;
    }
    std::string hex() const {
        std::string text;
        for (int shift = 60; shift >= 0; shift -= 4)
            text += "0123456789abcdef"[(hash_ >> shift) & 15u];
        return text;
    }

private:
    std::uint64_t hash_ = 0xcbf29ce484222325u;
};

[[noreturn]] void refuse(const std::string& file, const std::string& tensor,
                         const std::string& expected) {
    throw Error(ErrorKind::input, file + ": tensor '" + tensor + "': expected " + expected);
}

}  // namespace

std::vector<std::pair<std::string, Shape>> expected_tensors(const ModelConfig& config) {
    TensorList list;
    if (config.encoder == EncoderKind::gated)
        list_gated(config, list);
    else
        list_thesis(config, list);
    int in = config.unfolded() + 3, layer = 0;
    for (const int width : config.mlp) {
        list.linear("renderer.mlp." + std::to_string(layer++), width, in);
        in = width;
    }
    list.linear("renderer.mlp." + std::to_string(layer), 2, in);
    return list.take();
}

void check_model(const Model& model, const std::string& file) {
    check_config(model.config, file);
    Tensors surplus = model.weights;
    for (const auto& [name, shape] : expected_tensors(model.config)) {
        const std::string wanted = "shape " + shape_text(shape) + ", found ";
        const auto found = surplus.find(name);
        if (found == surplus.end()) refuse(file, name, wanted + "no such tensor");
        const Tensor& tensor = found->second;
        if (tensor.shape != shape || tensor.values.size() != element_count(shape))
            refuse(file, name, wanted + shape_text(tensor.shape));
        for (const float value : tensor.values)
            if (!std::isfinite(value))
                refuse(file, name, "finite numbers, found " + std::to_string(value));
        surplus.erase(found);
    }
    if (!surplus.empty())
        throw Error(ErrorKind::input, file + ": tensor '" + surplus.begin()->first +
                                          "': expected no tensor of that name, found shape " +
                                          shape_text(surplus.begin()->second.shape));
}

Model load_model(const std::filesystem::path& path) {
    TensorFile file = read_safetensors(path);
    Model model{parse_metadata(file.metadata, path.string()), std::move(file.tensors)};
    check_model(model, path.string());
    return model;
}

void save_model(const std::filesystem::path& path, const Model& model, bool overwrite) {
    check_model(model, path.string());
    write_safetensors(path, {format_metadata(model.config), model.weights}, overwrite);
}

std::string encoder_identity(const Model& model) {
    Digest digest;
    const auto metadata = format_metadata(model.config);
    for (const char* key :
         {"encoder", "bins", "widths", "recurrent", "gate_radius", "gate_spread"}) {
        const std::string& value = metadata.at(key);
        digest.add(value.c_str(), value.size() + 1);
    }
    for (const auto& [name, tensor] : model.weights) {
        if (!name.starts_with("encoder.")) continue;
        digest.add(name.c_str(), name.size() + 1);
        digest.add(tensor.values.data(), tensor.values.size() * sizeof(float));
    }
    return digest.hex();
}

std::string model_identity(const Model& model) {
    Digest digest;
    for (const auto& [key, value] : format_metadata(model.config)) {
        if (key == "card") continue;
        digest.add(key.c_str(), key.size() + 1);
        digest.add(value.c_str(), value.size() + 1);
    }
    for (const auto& [name, tensor] : model.weights) {
        digest.add(name.c_str(), name.size() + 1);
        digest.add(tensor.values.data(), tensor.values.size() * sizeof(float));
    }
    return digest.hex();
}

}  // namespace eventide
