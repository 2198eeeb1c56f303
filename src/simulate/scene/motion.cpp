// The thesis' control points, endless wandering, pauses, and changes of light.
#include "src/simulate/scene/motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace eventide {

namespace {

/// Second derivatives of the not-a-knot spline on a uniform grid of step 1. Not-a-knot makes the
/// first and last two pieces one polynomial, so the second and last but one are plain second
/// differences, and the rest is the usual tridiagonal system between them.
std::vector<double> not_a_knot(const std::vector<double>& p) {
    const std::size_t n = p.size();
    std::vector<double> bend(n, 0.0);
    if (n < 3) return bend;
    const auto difference = [&](std::size_t i) { return p[i - 1] - 2 * p[i] + p[i + 1]; };
    if (n == 3) return std::vector<double>(3, difference(1));
    bend[1] = difference(1);
    bend[n - 2] = difference(n - 2);
    std::vector<double> factor(n, 0.0);
    for (std::size_t i = 2; i + 2 < n; ++i) {  // Thomas' algorithm, forward
        const double pivot = 4 - factor[i - 1];
        const double last = i + 3 == n ? bend[n - 2] : 0;
        factor[i] = 1 / pivot;
        bend[i] = (6 * difference(i) - last - bend[i - 1]) / pivot;
    }
    for (std::size_t i = n - 3; n > 5 && i >= 3; --i) bend[i - 1] -= factor[i - 1] * bend[i];
    bend[0] = 2 * bend[1] - bend[2];
    bend[n - 1] = 2 * bend[n - 2] - bend[n - 3];
    return bend;
}

class ThesisMotion : public Motion {
public:
    ThesisMotion(const ThesisMotionSettings& settings, Random random)
        : duration_s_(settings.duration_s) {
        const double scale_factor = random.uniform(), angle_factor = random.uniform();
        const double s = settings.scale_max, d = settings.displacement_max;
        // One number of points and one kind of curve per transformation, as the thesis has it.
        const auto draw = [&](std::initializer_list<std::pair<Range, double>> channels,
                              double first) {
            const int n = random.integer(2, std::max(2, settings.control_points_max));
            const bool cubic = !random.chance(settings.linear_probability);
            for (const auto& [range, factor] : channels) {
                std::vector<double> values(static_cast<std::size_t>(n));
                for (double& v : values) v = random.uniform(range);
                const double origin = values.front();
                for (double& v : values) v = first + factor * (v - origin);
                curves_.emplace_back(std::move(values), cubic);
            }
        };
        draw({{{0, s}, scale_factor}, {{0, s}, scale_factor}}, 1);
        draw({{{0, settings.angle_max}, angle_factor}}, 0);
        draw({{{-d, d}, 1}, {{-d, d}, 1}}, 0);
    }

    void prepare(double) override {}
    void forget(double) override {}

    Pose at(double t_s) const override {
        const double turn = std::fmod(t_s / duration_s_, 2.0);
        const double share = turn <= 1 ? turn : 2 - turn;
        constexpr double kSmallestScale = .1;  // splines overshoot; the image must not turn over
        return {.x = curves_[3].at(share),
                .y = curves_[4].at(share),
                .angle = curves_[2].at(share),
                .scale_x = std::max(kSmallestScale, curves_[0].at(share)),
                .scale_y = std::max(kSmallestScale, curves_[1].at(share))};
    }

private:
    double duration_s_;
    std::vector<ControlCurve> curves_;  // scale x, scale y, angle, displacement x, displacement y
};

class WanderMotion : public Motion {
public:
    WanderMotion(const WanderSettings& settings, double speed, double radius, Point start,
                 const Home& home, Random random)
        : home_(home), speed_(speed), zoom_max_(settings.zoom_max), random_(random) {
        const bool tremble = settings.tremble > 0 && random_.chance(settings.tremble);
        leg_s_ = random_.log_uniform(tremble ? settings.tremble_leg_s : settings.leg_s);
        const double width = home.x1 - home.x0, height = home.y1 - home.y0;
        // A leg that leaves home far behind would mean a thing hardly ever seen.
        if (width > 0 && speed > 0)
            leg_s_ = std::min(leg_s_, home.longest_leg * std::hypot(width, height) / speed);
        turn_ = random_.uniform(tremble ? settings.tremble_turn : settings.turn);
        spin_ = random_.uniform(settings.spin_share) * speed / radius;
        zoom_ = random_.uniform(settings.zoom_share) * speed / radius;
        cubic_ = !random_.chance(settings.linear_probability);
        heading_ = random_.uniform({0, 2 * std::numbers::pi});
        if (settings.pace.low != 1 || settings.pace.high != 1) {
            paces_ = settings.pace;
            pace_change_ = std::min(1.0, leg_s_ / random_.log_uniform(settings.pace_s));
        }
        Knot first{start.x, start.y, 0, 0};
        if (width > 0) first.angle = random_.uniform({0, 2 * std::numbers::pi});
        knots_.push(first);
    }

    void prepare(double until_s) override {
        while (double(knots_.end() - 3) * leg_s_ <= until_s)
            knots_.push(next(knots_[knots_.end() - 1]));
    }
    void forget(double before_s) override { knots_.forget(std::int64_t(before_s / leg_s_) - 2); }

    Pose at(double t_s) const override {
        const double legs = t_s / leg_s_;
        const auto k = std::int64_t(legs);
        const double u = legs - double(k);
        const Knot &b = knots_[k], &c = knots_[k + 1];
        const Knot& a = k > 0 ? knots_[k - 1] : b;
        const Knot& d = knots_[k + 2];
        const auto value = [&](double Knot::*m) {
            if (!cubic_) return b.*m + u * (c.*m - b.*m);
            // Catmull and Rom: slopes are half the difference of the neighbours.
            const double p = b.*m, q = c.*m, s = (c.*m - a.*m) / 2, r = (d.*m - b.*m) / 2;
            const double e = q - p;
            return p + u * (s + u * (3 * e - 2 * s - r + u * (s + r - 2 * e)));
        };
        const double scale = std::exp(value(&Knot::log_scale));
        return {value(&Knot::x), value(&Knot::y), value(&Knot::angle), scale, scale};
    }

private:
    struct Knot {
        double x = 0, y = 0, angle = 0, log_scale = 0;
    };

    Knot next(const Knot& from) {
        Knot to = from;
        heading_ += turn_ * random_.normal();
        // A hand that shook fast and then holds nearly still: few events then say nothing of
        // contrast.
        if (pace_change_ > 0 && random_.chance(pace_change_)) pace_ = random_.log_uniform(paces_);
        const double length = pace_ * speed_ * leg_s_ * std::exp(.4 * random_.normal() - .08);
        const auto go = [&] {
            to.x = from.x + length * std::cos(heading_);
            to.y = from.y + length * std::sin(heading_);
        };
        go();
        const bool homeless = home_.x1 <= home_.x0;
        if (!homeless &&
            (to.x < home_.x0 || to.x > home_.x1 || to.y < home_.y0 || to.y > home_.y1)) {
            heading_ = std::atan2(random_.uniform({home_.y0, home_.y1}) - from.y,
                                  random_.uniform({home_.x0, home_.x1}) - from.x);
            go();
        }
        to.angle += pace_ * spin_ * leg_s_ * random_.normal();
        to.log_scale += pace_ * zoom_ * leg_s_ * random_.normal();
        to.log_scale = std::clamp(to.log_scale, -zoom_max_, zoom_max_);
        return to;
    }

    Home home_;
    double speed_, zoom_max_, leg_s_ = 1, turn_ = 0, spin_ = 0, zoom_ = 0, heading_ = 0;
    Range paces_{1, 1};
    double pace_ = 1, pace_change_ = 0;  // probability per leg
    bool cubic_ = false;
    Random random_;
    Knots<Knot> knots_;
};

}  // namespace

ControlCurve::ControlCurve(std::vector<double> values, bool cubic) : values_(std::move(values)) {
    bend_ = cubic ? not_a_knot(values_) : std::vector<double>(values_.size(), 0.0);
}

double ControlCurve::at(double share) const {
    const std::size_t last = values_.size() - 1;
    const double x = share * double(last);
    const std::size_t k = std::min(std::size_t(x), last - 1);
    const double b = x - double(k), a = 1 - b;
    return a * values_[k] + b * values_[k + 1] +
           ((a * a * a - a) * bend_[k] + (b * b * b - b) * bend_[k + 1]) / 6;
}

std::unique_ptr<Motion> thesis_motion(const ThesisMotionSettings& settings, Random random) {
    return std::make_unique<ThesisMotion>(settings, random);
}

Affine thesis_transform(const Pose& pose) {
    return Affine::scale(1 / pose.scale_x, 1 / pose.scale_y)
        .after(Affine::translation(-pose.x, -pose.y))
        .after(Affine::rotation(-pose.angle));
}

std::unique_ptr<Motion> wander_motion(const WanderSettings& settings, double speed, double radius,
                                      Point start, const Home& home, Random random) {
    return std::make_unique<WanderMotion>(settings, speed, radius, start, home, random);
}

PauseClock::PauseClock(double start_probability, double stay_probability, double step_s,
                       Random random)
    : start_(start_probability), stay_(stay_probability), step_s_(step_s), random_(random) {
    steps_.push({});
}

void PauseClock::prepare(double until_s) {
    while (double(steps_.end() - 1) * step_s_ <= until_s) {
        const Step& last = steps_[steps_.end() - 1];
        steps_.push(
            {last.moved + (last.paused ? 0 : 1), random_.chance(last.paused ? stay_ : start_)});
    }
}

void PauseClock::forget(double before_s) {
    steps_.forget(std::int64_t(before_s / step_s_) - 1);
}

double PauseClock::at(double t_s) const {
    const double steps = t_s / step_s_;
    const auto k = std::int64_t(steps);
    const Step& step = steps_[k];
    return (double(step.moved) + (step.paused ? 0 : steps - double(k))) * step_s_;
}

LightChanges::LightChanges(double depth, double step_s, Random random)
    : depth_(depth), step_s_(step_s), random_(random) {
    levels_.push(-depth_ * random_.uniform());
}

void LightChanges::prepare(double until_s) {
    while (double(levels_.end() - 2) * step_s_ <= until_s) {
        // Half of the time the light stays: changes are news, not the rule.
        const double last = levels_[levels_.end() - 1];
        levels_.push(random_.chance(.5) ? last : -depth_ * random_.uniform());
    }
}

void LightChanges::forget(double before_s) {
    levels_.forget(std::int64_t(before_s / step_s_) - 1);
}

double LightChanges::log_gain(double t_s) const {
    const double steps = t_s / step_s_;
    const auto k = std::int64_t(steps);
    return levels_[k] + (steps - double(k)) * (levels_[k + 1] - levels_[k]);
}

}  // namespace eventide
