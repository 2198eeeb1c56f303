// Filters behind a reader or camera.
#include "library/source_filters.h"

#include "library/pushed_images.h"
#include "src/core/error.h"

namespace eventide {

void SourceFilters::add(const std::string& text) {
    if (has_begun_)
        throw Error(ErrorKind::usage, "filter " + text +
                                          ": expected a source that nothing has been read from, "
                                          "found one that is being read");
    if (info_.width < 1 || info_.height < 1)
        throw Error(ErrorKind::usage, "filter " + text +
                                          ": expected a sensor of known size, found a recording "
                                          "that does not say it; give width and height");
    chain_.add(text);
    info_ = chain_.behind(sensor_);
}

void SourceFilters::process(Batch& batch) {
    has_begun_ = true;
    chain_.process(batch);
    tell_filter(info_.colour_filter, batch.images);
}

}  // namespace eventide
