// A model's networks in double precision.
#include "apps/cli/stress/double_network.h"

#include "apps/cli/stress/worst.h"
#include "src/model/encode/plain_encoder.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace eventide::stress {
namespace {

template <typename Network>
class Of final : public DoubleNetwork {
public:
    Of(const Model& model, int height, int width) : network_{model, height, width} {}

    Array3<double> step(const Array3<double>& grid) override { return network_.step(grid); }
    void go_on_from(const TensorFile& state) override {
        for (std::size_t l = 0; l < network_.states().size(); ++l)
            std::ranges::copy(state.tensors.at("h." + std::to_string(l)).values,
                              network_.states()[l].values().begin());
    }
    void reset() override {
        for (Array3<double>& state : network_.states()) std::ranges::fill(state.values(), 0.0);
    }

private:
    Network network_;
};

}  // namespace

std::unique_ptr<DoubleNetwork> make_double(const Model& model, int height, int width) {
    if (model.config.encoder == EncoderKind::gated)
        return std::make_unique<Of<plain::GatedEncoder<double>>>(model, height, width);
    return std::make_unique<Of<plain::ThesisEncoder<double>>>(model, height, width);
}

Array3<double> in_double(const Array3<float>& map) {
    Array3<double> wide{map.height(), map.width(), map.channels()};
    std::ranges::copy(map.values(), wide.values().begin());
    return wide;
}

void Distance::add(std::span<const float> fast, std::span<const double> exact) {
    double largest = 1, most = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        const double difference = std::abs(double(fast[i]) - exact[i]);
        most = worst_of(most, difference);
        largest = std::max(largest, std::abs(exact[i]));
        squares += difference * difference;
        power += exact[i] * exact[i];
        lowest = std::min(lowest, exact[i]);
        highest = std::max(highest, exact[i]);
    }
    worst = worst_of(worst, most / largest);
    compared += exact.size();
}

void Distance::add(const Distance& other) {
    worst = worst_of(worst, other.worst);
    squares += other.squares;
    power += other.power;
    lowest = std::min(lowest, other.lowest);
    highest = std::max(highest, other.highest);
    compared += other.compared;
}

double Distance::rms() const {
    return power == 0 ? 0 : std::sqrt(squares / power);
}

double Distance::rms_of_range() const {
    return lowest == highest ? 0 : std::sqrt(squares / double(compared)) / (highest - lowest);
}

}  // namespace eventide::stress
