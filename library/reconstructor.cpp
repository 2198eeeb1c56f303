// The public face of the network at work.
#include "library/reconstructor_impl.h"
#include "src/core/error.h"
#include "src/core/sensor_limits.h"
#include "src/model/model_folders.h"
#include "src/model/model_trial.h"
#include "src/nn/safetensors.h"

#include <new>
#include <string>

namespace eventide {
namespace {

/// Before anything is made for it.
void check_side(int side, const char* name) {
    if (side < 1 || side > kLargestSensorSide)
        throw Error(ErrorKind::usage, std::string{"sensor "} + name + ": expected 1 to " +
                                          std::to_string(kLargestSensorSide) + " px, found " +
                                          std::to_string(side));
}

/// A model file whose network was seen to work.
Model tried_model(const std::string& name) {
    const std::filesystem::path file = find_model(name);
    Model model = load_model(file);
    try_model(model, file.string());
    return model;
}

}  // namespace

Reconstructor::Reconstructor(const std::string& model, int width, int height,
                             const ReconstructorOptions& options) {
    check_side(width, "width");
    check_side(height, "height");
    try {
        impl_ = std::make_unique<Impl>(tried_model(model), width, height, options);
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::failed, "model '" + model + "' for a sensor of " +
                                           std::to_string(width) + "x" + std::to_string(height) +
                                           ": expected enough memory for it, found too little");
    }
}

Reconstructor::~Reconstructor() = default;
Reconstructor::Reconstructor(Reconstructor&&) noexcept = default;
Reconstructor& Reconstructor::operator=(Reconstructor&&) noexcept = default;

int Reconstructor::width() const noexcept {
    return impl_->encoder().width();
}
int Reconstructor::height() const noexcept {
    return impl_->encoder().height();
}
std::string Reconstructor::description() const {
    return impl_->encoder().description();
}
void Reconstructor::push(std::span<const Event> events) {
    impl_->intake().push(events);
}
void Reconstructor::push(const Batch& batch) {
    impl_->intake().push(batch);
}
void Reconstructor::advance(SensorTime now) {
    impl_->intake().advance(now);
}
void Reconstructor::mark_gap() noexcept {
    impl_->intake().mark_gap();
}
void Reconstructor::finish(std::optional<SensorTime> end) {
    impl_->intake().finish(end);
}
bool Reconstructor::next(Frame& frame) {
    return impl_->next(frame);
}
Readiness Reconstructor::readiness(SensorTime t) {
    return impl_->readiness(t);
}
void Reconstructor::render(SensorTime t, Frame& frame) {
    impl_->render(t, frame);
}
void Reconstructor::render(SensorTime t, const FrameSize& size, Frame& frame) {
    impl_->render(t, size, frame);
}
std::optional<SensorTime> Reconstructor::newest() {
    return impl_->newest();
}
void Reconstructor::reset() {
    impl_->reset();
}
void Reconstructor::save_state(const std::filesystem::path& file, bool overwrite) const {
    write_safetensors(file, impl_->encoder().state(), overwrite);
}
void Reconstructor::restore_state(const std::filesystem::path& file) {
    impl_->restore_state(file);
}
ReconstructorCounters Reconstructor::counters() const noexcept {
    return impl_->counters();
}

}  // namespace eventide
