// Region, crop, flip and undistortion -> where a frame lies on the sensor.
#include "apps/cli/run/sink_geometry.h"

namespace eventide::app {

namespace {

ShownPart part_of_sensor(const Region& region, const Size& frame) {
    const double width = frame.width, height = frame.height;
    return {region.x / width, region.y / height,
            (region.width > 0 ? region.width : frame.width - region.x) / width,
            (region.height > 0 ? region.height : frame.height - region.y) / height};
}

Region asked_region(const RunSettings& settings) {
    return settings.region.value_or(Region{});
}

}  // namespace

ShownPart rendered_part(const RunSettings& settings, const Size& sensor,
                        const std::optional<UndistortionPlan>& undistortion) {
    return part_of_sensor(
        undistortion && settings.region ? undistortion->source : asked_region(settings),
        settings.size.of(sensor));
}

ShownPart shown_part(const RunSettings& settings, const Size& sensor) {
    const Size frame = settings.size.of(sensor);
    ShownPart part = part_of_sensor(asked_region(settings), frame);
    const double x = double(settings.adjust.crop_px) / frame.width,
                 y = double(settings.adjust.crop_px) / frame.height;
    part = {part.left + x, part.top + y, part.width - 2 * x, part.height - 2 * y};
    const Flip flip = settings.adjust.flip;
    if (flip == Flip::horizontal || flip == Flip::both) part.left = 1 - part.left - part.width;
    if (flip == Flip::vertical || flip == Flip::both) part.top = 1 - part.top - part.height;
    return part;
}

ImageGeometry image_geometry(const RunSettings& settings, const Size& sensor) {
    ImageGeometry geometry;
    const Size whole = settings.size.of(sensor);
    geometry.width = whole.width;
    geometry.height = whole.height;
    if (settings.region) {
        geometry.left = settings.region->x;
        geometry.top = settings.region->y;
    }
    geometry.left += settings.adjust.crop_px;
    geometry.top += settings.adjust.crop_px;
    geometry.flip = settings.adjust.flip;
    return geometry;
}

}  // namespace eventide::app
