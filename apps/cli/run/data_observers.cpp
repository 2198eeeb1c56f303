#include "apps/cli/run/data_observers.h"

#include "pipeline/demosaiced.h"

namespace eventide::app {

void DataObservers::see(const Batch& batch) {
    if (file_ != nullptr) file_->see(batch);
    if (batch.images.empty() || (shown_ == nullptr && corrections_ == nullptr)) return;
    Batch images;
    for (const ReferenceImage& image : batch.images)
        images.images.push_back(demosaiced(image, filter_));
    if (shown_ != nullptr) shown_->see(images);
    if (corrections_ == nullptr) return;
    corrections_->put(std::move(images.images));
    if (networks_ != nullptr) networks_->see(batch.images);
}

}  // namespace eventide::app
