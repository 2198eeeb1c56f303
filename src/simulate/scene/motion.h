// How things in a scene move: affine poses, pauses and changes of light, as functions of time.
#pragma once

#include "src/simulate/random.h"
#include "src/simulate/scene/affine.h"
#include "src/simulate/scene/scene_settings.h"

#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

namespace eventide {

/// Values at equal steps of time, made on demand at the end and forgotten at the beginning, so that
/// a stream may run for ever.
template <typename T>
class Knots {
public:
    std::int64_t end() const { return first_ + std::int64_t(values_.size()); }
    void push(const T& value) { values_.push_back(value); }
    const T& operator[](std::int64_t k) const { return values_[std::size_t(k - first_)]; }
    void forget(std::int64_t before) {
        for (; first_ < before && values_.size() > 4; ++first_) values_.pop_front();
    }

private:
    std::deque<T> values_;
    std::int64_t first_ = 0;
};

struct Pose {
    double x = 0, y = 0;  ///< displacement
    double angle = 0;     ///< rad
    double scale_x = 1, scale_y = 1;
};

/// Seconds are those of the scene's own clock, which stands still in pauses; never below 0.
class Motion {
public:
    virtual ~Motion() = default;
    virtual void prepare(double until_s) = 0;  ///< at() may be asked up to here
    virtual void forget(double before_s) = 0;  ///< at() will not be asked before
    virtual Pose at(double t_s) const = 0;
};

/// A curve through values at equal times: straight, or the not-a-knot cubic spline (the one that
/// scipy's interp1d(kind="cubic") draws, which the thesis used; a parabola through three values).
class ControlCurve {
public:
    ControlCurve(std::vector<double> values, bool cubic);
    double at(double share) const;  ///< 0 at the first value, 1 at the last

private:
    std::vector<double> values_;
    std::vector<double> bend_;  // second derivatives, in units of one interval
};

std::unique_ptr<Motion> thesis_motion(const ThesisMotionSettings& settings, Random random);

/// The thesis' A = S D R (its equations 3.5 to 3.7): where in the image a place of the sensor
/// looks; [-1, 1] are the edges of both. A scale of 2 shows things twice as large, a positive
/// displacement moves them right and down (1 takes the middle to the edge), a positive angle turns
/// them from the x axis towards the y axis.
Affine thesis_transform(const Pose& pose);

/// Where something may roam; the legs turn back at its edge. Empty (x1 <= x0): anywhere.
struct Home {
    double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    double longest_leg = 1;  ///< share of the diagonal; the longer, the further beyond the edge
};

/// `speed` in px/s, `radius` (px) turns the shares of spin and zoom into rates.
std::unique_ptr<Motion> wander_motion(const WanderSettings& settings, double speed, double radius,
                                      Point start, const Home& home, Random random);

/// Time that stands still now and then: a Markov chain over steps.
class PauseClock {
public:
    PauseClock(double start_probability, double stay_probability, double step_s, Random random);
    void prepare(double until_s);
    void forget(double before_s);
    double at(double t_s) const;  ///< seconds of motion since 0

private:
    struct Step {
        std::int64_t moved = 0;  // steps of motion before this one
        bool paused = false;
    };
    double start_, stay_, step_s_;
    Random random_;
    Knots<Step> steps_;
};

/// Light that grows and fades: straight lines in the logarithm between levels in [-depth, 0].
class LightChanges {
public:
    LightChanges(double depth, double step_s, Random random);
    void prepare(double until_s);
    void forget(double before_s);
    double log_gain(double t_s) const;
    double steepest() const { return depth_ / step_s_; }  ///< ln per second, at most

private:
    double depth_, step_s_;
    Random random_;
    Knots<double> levels_;
};

}  // namespace eventide
