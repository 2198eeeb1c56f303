// What the networks of a run remember, as one file.
#include "apps/cli/run/state/run_state.h"

#include "src/core/error.h"

#include <string_view>
#include <utility>

namespace eventide::app {

namespace {

constexpr const char* kFilterKey = "colour_filter";

std::string prefix_of(ColourChannel channel) {
    switch (channel) {
        case ColourChannel::blue:
            return "blue.";
        case ColourChannel::green:
            return "green.";
        default:
            return "red.";
    }
}

/// Takes the tensors under the channel's name out of the file; those of half the sensor's size.
TensorFile take_channel(TensorFile& file, ColourChannel channel, const Encoder& encoder) {
    const std::string prefix = prefix_of(channel);
    TensorFile own{file.metadata, {}};
    own.metadata["width"] = std::to_string(encoder.width());
    own.metadata["height"] = std::to_string(encoder.height());
    for (auto each = file.tensors.lower_bound(prefix);
         each != file.tensors.end() && each->first.starts_with(prefix);) {
        own.tensors[each->first.substr(prefix.size())] = std::move(each->second);
        each = file.tensors.erase(each);
    }
    return own;
}

void check_filter(const TensorFile& state, const std::string& name, ColourFilter filter) {
    const auto found = state.metadata.find(kFilterKey);
    const std::string kept = found == state.metadata.end() ? "none" : found->second;
    if (kept == name_of(filter)) return;
    const auto words = [](std::string_view what) {
        return what == "none" ? std::string("without colours")
                              : "with those of " + std::string(what) + " (--colour)";
    };
    throw Error(ErrorKind::input, name + ": expected the state of a run " + words(name_of(filter)) +
                                      ", found that of one " + words(kept));
}

}  // namespace

TensorFile state_of(const Network& network, const ColourNetworks* colour) {
    TensorFile all = network.encoder().state();
    if (colour == nullptr) return all;
    all.metadata[kFilterKey] = name_of(colour->filter());
    for (const ColourChannel channel : kColourChannels)
        for (auto& [name, tensor] : colour->encoder(channel).state().tensors)
            all.tensors[prefix_of(channel) + name] = tensor;
    return all;
}

void restore_state(TensorFile state, const std::string& file, Network& network,
                   ColourNetworks* colour) {
    check_filter(state, file, colour == nullptr ? ColourFilter::none : colour->filter());
    if (colour != nullptr)
        for (const ColourChannel channel : kColourChannels) {
            Encoder& encoder = colour->encoder(channel);
            encoder.restore(take_channel(state, channel, encoder), file);
        }
    network.encoder().restore(state, file);
}

}  // namespace eventide::app
