// A sensor before a textured scene that moves for a while and then stands still for good, with the
// noise of a real camera.
#pragma once

#include "src/simulate/random.h"
#include "src/simulate/sensor/event_sensor.h"

#include <vector>

namespace eventide::stress {

class StillScene {
public:
    /// Sensor of width x height px; time begins at 0.
    StillScene(int width, int height, SensorDuration moving);

    /// Appends the events of the next 10 ms of motion or 100 ms of standing still.
    void advance(std::vector<Event>& events);
    SensorTime now() const { return now_; }

private:
    void draw(double t_s);

    int width_, height_;
    SensorDuration moving_;
    Array2<float> lux_;
    EventSensor sensor_;
    SensorTime now_{};
};

}  // namespace eventide::stress
