// The public face of the network at work.
#include "library/network_options.h"
#include "library/reconstructor_impl.h"
#include "src/nn/safetensors.h"

#include <string>

namespace eventide {

Reconstructor::Reconstructor(const std::string& model, int width, int height,
                             const ReconstructorOptions& options) {
    check_sensor(width, height);
    impl_ = with_enough_memory(model, width, height, [&] {
        return std::make_unique<Impl>(tried_model(model), width, height, options);
    });
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
    impl_->restore(read_safetensors(file), file.string());
}
std::vector<std::byte> Reconstructor::state() const {
    return format_safetensors(impl_->encoder().state());
}
void Reconstructor::restore(std::span<const std::byte> state) {
    impl_->restore(parse_safetensors(state, "state"), "state");
}
ReconstructorCounters Reconstructor::counters() const noexcept {
    return impl_->counters();
}

}  // namespace eventide
