// A fusion of images with a model that shows nothing but grey.
#pragma once

#include "src/model/render/image_fusion.h"
#include "tests/model/fusion_images.h"

#include <gtest/gtest.h>

namespace eventide::test {

class ImageFusionTest : public testing::Test {
protected:
    /// The model shows a grey, .4 unless said otherwise, throughout.
    void advance(double end_ms, float events = 0, float value = .4F) {
        const Frame at_end = grey(value, at_ms(end_ms));
        fusion_.advance({at_ms(now_ms_), at_ms(end_ms)}, constant(events), &at_end);
        now_ms_ = end_ms;
    }
    /// The model's grey, .4 unless said otherwise, corrected.
    Frame shown(double ms, const RenderRequest& request = {}, float value = .4F) {
        const int width = request.width > 0 ? request.width : kWidth;
        const int height = request.height > 0 ? request.height : kHeight;
        Frame frame =
            grey(value, at_ms(ms), request.region.height > 0 ? request.region.height : height,
                 request.region.width > 0 ? request.region.width : width);
        fusion_.prepare(request);
        fusion_.apply(request, constant(value), frame);
        return frame;
    }
    bool correct(const Array2<float>& seen, double ms) {
        return fusion_.correct(image_of(seen, at_ms(ms)), grey(.4F, at_ms(ms)));
    }

    ImageFusion fusion_{kWidth, kHeight};
    double now_ms_ = 0;
};

}  // namespace eventide::test
