// What a scene is drawn from: every range, with the values that training uses as defaults.
#pragma once

#include "src/simulate/random.h"

#include <numbers>

namespace eventide {

/// How the background moves.
enum class BackgroundMotion {
    wander,  ///< endless: legs of random heading at a drawn speed, with spin and zoom
    thesis   ///< control points at equal times over `duration_s`, then back and forth
             ///< (docs/training.md, "The thesis' scenes")
};

/// What the truth shows.
enum class TargetRule {
    exposed,  ///< what a camera with auto-exposure, black level and saturation would deliver
    texture   ///< the textures' own grey values (the thesis' choice)
};

/// The thesis' affine motion (its table 3.1, row "train"). [-1, 1] are the image's edges.
struct ThesisMotionSettings {
    int control_points_max = 10;     ///< N max; at least 2
    double scale_max = .7;           ///< s max
    double angle_max = 1.7;          ///< rad
    double displacement_max = .6;    ///< half image sizes
    double linear_probability = .5;  ///< else a cubic spline
    double duration_s = 5;           ///< T event windows of 50 ms
};

/// Endless motion. Speeds are of the sensor's pixels.
struct WanderSettings {
    Range speed{.1, 600};             ///< px/s, log-uniform
    Range usual_speed{4, 250};        ///< px/s, log-uniform; most scenes' ...
    double usual = .75;               ///< ... with this probability, else all of `speed`
    Range leg_s{.05, 1.5};            ///< log-uniform; time between changes of heading
    Range turn{0, std::numbers::pi};  ///< rad, deviation of the change of heading per leg
    Range spin_share{0, .5};          ///< speed at the rim by rotation, as a share of `speed`
    Range zoom_share{0, .3};          ///< speed at the rim by scaling, as a share of `speed`
    double zoom_max = .5;             ///< ln of the largest magnification either way
    double linear_probability = .5;   ///< else cubic through the legs' ends
    Range pace{1, 1};                 ///< log-uniform; times the speed, drawn anew now and then ...
    Range pace_s{.15, 2};             ///< ... log-uniform; after so long on average
    double tremble = 0;               ///< probability of shaking about one place instead ...
    Range tremble_leg_s{.012, .15};   ///< ... log-uniform; by legs this short ...
    Range tremble_turn{2, std::numbers::pi};  ///< ... that turn back this far (rad)
};

struct SceneSettings {
    BackgroundMotion background = BackgroundMotion::wander;
    ThesisMotionSettings thesis;
    WanderSettings wander;
    Range view_share{.2, 1.1};      ///< log-uniform; share of the texture that the sensor sees ...
    double magnified_most = 1.6;    ///< ... but no texture pixel is shown larger than this, in px
    double still_background = .15;  ///< probability of a camera that does not move

    int objects_min = 0, objects_max = 30;
    double objects_skew = 2;     ///< number = min + (max - min) u^skew: most scenes have few
    int pinned_max = 0;          ///< things fixed to a wandering background, evenly 0 to this
    double object_flat = 0;      ///< probability of one grey all over: what only its edges tell
    Range object_size{.06, .6};  ///< log-uniform; full length over the sensor's shorter side
    Range object_aspect{.3, 1};  ///< width over length
    Range object_speed{.2, 5};   ///< log-uniform; times the scene's speed, within wander.speed
    double object_reach = .5;    ///< how far beyond the sensor they roam, in their lengths
    double polygon_probability = .5;  ///< else an ellipse, or a ring
    double ring_probability = .1;
    Range edge_softness_px{0, 2};  ///< width of the blur at an object's edge
    Range opacity{1, 1};           ///< of objects; below 1 they are glass
    double lamp = 0;  ///< light of a disc that roams before all else, over that of white; 0: none

    double pause_start = .05, pause_stay = .9;  ///< per `pause_step_s`, of the whole scene
    double pause_step_s = .05;
    double object_pauses = .3;  ///< probability that an object keeps pauses of its own

    Range white_lux{5, 15000};      ///< log-uniform; illuminance on the chip of grey value 1
    Range dynamic_range{4, 400};    ///< log-uniform; white over black
    Range black_lux{0, 0};          ///< where high > 0: both ends are drawn evenly in lux instead
    Range tone{.05, 2.4};           ///< k in norm01(exp(k x)); 0 is linear
    Range object_gain{.4, 1.6};     ///< log-uniform; an object's light over the background's
    double faint_probability = .1;  ///< scenes whose grey values span only `faint_contrast`
    Range faint_contrast{.05, .4};
    double light_change_probability = .2;     ///< scenes whose light changes
    Range light_change{.1, 1.2};              ///< ln, largest change
    Range light_change_s{.03, 2};             ///< log-uniform; time of one change
    double flicker_probability = .1;          ///< scenes under mains light
    double object_flicker_probability = .02;  ///< objects that shine by themselves (screens, lamps)
    Range flicker_depth{.05, .6};             ///< share of the light

    TargetRule target = TargetRule::exposed;
    // Where real DAVIS images lie: means .20 to .48, deviations .12 to .28 (the five recordings at
    // hand); photographs: .25 to .6 and .11 to .3.
    Range target_mean{.17, .54};
    Range target_deviation{.14, .32};
    Range target_black{-.25, .15};        ///< level that darkness is read out as, at most
    Range target_white{.45, 1};           ///< level at which the pixels saturate ...
    double target_white_below_one = .25;  ///< ... with this probability; else 1
    Range target_gamma{1, 2.2};           ///< I ~ L^(1 / gamma); 1 is linear in light as an APS is
    double exposure_fixed = .4;           ///< probability that exposure stays as at the start
    Range exposure_lag_s{.3, 10};         ///< log-uniform; else it follows with this time constant

    double step_px = .5;       ///< nothing moves further between two sub-frames ...
    Range step_s{.0001, .01};  ///< ... within these bounds
};

}  // namespace eventide
