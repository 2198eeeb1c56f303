// tracker RECORDING [TRUTH/]: how the camera moves, from corners that are followed from frame to
// frame, each weighed by the sigma of the pixels around it. TRUTH/ is what `eventide simulate
// --truth` wrote beside the recording: then errors are printed for each way to weigh, in px.
#include <eventide/eventide.hpp>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

namespace {

using eventide::Frame;
using Affine = cv::Matx23d;

/// A corner in two frames, and the larger sigma of its surroundings in either.
struct Track {
    cv::Point2f from, to;
    double sigma = 0;
};

/// What a measurement counts for.
struct Weighing {
    const char* name;
    std::function<double(double sigma)> weight;
};

constexpr double kSure = .13, kDoubtful = .2, kDoubtfulWeight = .25, kLeastSigma = .01;

const std::vector<Weighing>& weighings() {
    static const std::vector<Weighing> all{
        {"equal weights", [](double) { return 1.0; }},
        {"steps", [](double s) { return s < kSure       ? 1.0
                                        : s < kDoubtful ? kDoubtfulWeight
                                                        : 0.0; }},
        {"1/sigma^2", [](double s) { return 1 / std::pow(std::max(s, kLeastSigma), 2); }}};
    return all;
}

cv::Mat as_image(const Frame& frame) {
    const cv::Mat values(frame.intensity.height(), frame.intensity.width(), CV_32FC1,
                         const_cast<float*>(frame.intensity.values().data()));
    cv::Mat image;
    values.convertTo(image, CV_8UC1, 255);
    return image;
}

constexpr int kReach = 7;  // px, of the tracker's window and of what sigma is averaged over

double sigma_around(const Frame& frame, cv::Point2f at) {
    const cv::Rect whole(0, 0, frame.sigma.width(), frame.sigma.height());
    const cv::Rect near =
        cv::Rect(int(at.x) - kReach, int(at.y) - kReach, 2 * kReach + 1, 2 * kReach + 1) & whole;
    if (near.empty()) return 1;
    const cv::Mat values(whole.height, whole.width, CV_32FC1,
                         const_cast<float*>(frame.sigma.values().data()));
    return cv::mean(values(near))[0];
}

/// Corners of the first frame, found again in the second.
std::vector<Track> follow(const cv::Mat& first, const cv::Mat& second) {
    std::vector<cv::Point2f> from, to;
    cv::goodFeaturesToTrack(first, from, 200, .01, kReach);
    if (from.empty()) return {};
    std::vector<unsigned char> found;
    std::vector<float> error;
    cv::calcOpticalFlowPyrLK(first, second, from, to, found, error,
                             {2 * kReach + 1, 2 * kReach + 1}, 3);
    std::vector<Track> tracks;
    for (std::size_t i = 0; i < from.size(); ++i)
        if (found[i] != 0) tracks.push_back({from[i], to[i]});
    return tracks;
}

/// x' = A x + b with the least sum of weighted squares. False where too few points count.
bool fit(const std::vector<Track>& tracks, const std::function<double(double)>& weight,
         Affine& motion) {
    constexpr int kLeast = 6;
    cv::Matx33d normal = cv::Matx33d::zeros();
    cv::Matx32d right = cv::Matx32d::zeros();
    int counting = 0;
    for (const Track& track : tracks) {
        const double w = weight(track.sigma);
        const cv::Vec3d point(track.from.x, track.from.y, 1);
        normal += w * point * point.t();
        right += w * point * cv::Vec2d(track.to.x, track.to.y).t();
        counting += w > 0;
    }
    cv::Matx32d solution;
    if (counting < kLeast || !cv::solve(normal, right, solution, cv::DECOMP_CHOLESKY)) return false;
    motion = solution.t();
    return true;
}

cv::Point2d moved(const Affine& motion, cv::Point2d p) {
    const cv::Vec2d q = motion * cv::Vec3d(p.x, p.y, 1);
    return {q[0], q[1]};
}

/// Mean square distance over the frame, px^2.
double square_error(const Affine& a, const Affine& b, cv::Size size) {
    constexpr int kGrid = 8;
    double sum = 0;
    for (int i = 0; i <= kGrid; ++i)
        for (int j = 0; j <= kGrid; ++j) {
            const cv::Point2d at(double(i) * size.width / kGrid, double(j) * size.height / kGrid);
            const cv::Point2d off = moved(a, at) - moved(b, at);
            sum += off.dot(off);
        }
    return sum / ((kGrid + 1) * (kGrid + 1));
}

/// What was seen of one way to weigh.
struct Score {
    double square_sum = 0;
    int pairs = 0;
    std::vector<double> errors;

    void add(double square) {
        square_sum += square;
        errors.push_back(std::sqrt(square));
        ++pairs;
    }
    double part(double share) {
        std::sort(errors.begin(), errors.end());
        return errors.empty() ? 0 : errors[std::size_t(share * double(errors.size() - 1))];
    }
};

class Comparison {
public:
    Comparison() : scores_(weighings().size() + 1) {}

    void add(const std::vector<Track>& tracks, const cv::Mat& truth_before,
             const cv::Mat& truth_now) {
        Affine truth;
        if (!robust(follow(truth_before, truth_now), truth)) return;
        for (std::size_t i = 0; i < weighings().size(); ++i) {
            Affine motion;
            if (fit(tracks, weighings()[i].weight, motion))
                scores_[i].add(square_error(motion, truth, truth_now.size()));
        }
        Affine motion;
        if (robust(tracks, motion))
            scores_.back().add(square_error(motion, truth, truth_now.size()));
        for (const Track& track : tracks) {
            const cv::Point2d off = moved(truth, track.from) - cv::Point2d(track.to);
            Score& bin = bins_[track.sigma < .13 ? 0 : track.sigma < .2 ? 1 : 2];
            bin.add(off.dot(off));
        }
    }

    void print() {
        std::printf("%-14s %6s %8s %8s %8s\n", "motion", "pairs", "median", "90 %", "rms, px");
        for (std::size_t i = 0; i < scores_.size(); ++i)
            print_row(i < weighings().size() ? weighings()[i].name : "RANSAC", scores_[i]);
        const char* names[]{"sigma < .13", ".13 to .2", "above"};
        std::printf("%-14s\n", "corners");
        for (int i = 0; i < 3; ++i) print_row(names[i], bins_[i]);
    }

private:
    static bool robust(const std::vector<Track>& tracks, Affine& motion) {
        std::vector<cv::Point2f> from, to;
        for (const Track& track : tracks) {
            from.push_back(track.from);
            to.push_back(track.to);
        }
        if (from.size() < 6) return false;
        const cv::Mat found = cv::estimateAffine2D(from, to, cv::noArray(), cv::RANSAC, 1.0);
        if (found.empty()) return false;
        motion = Affine(found);
        return true;
    }
    static void print_row(const char* name, Score& score) {
        std::printf("%-14s %6d %8.3f %8.3f %8.3f\n", name, score.pairs, score.part(.5),
                    score.part(.9), std::sqrt(score.square_sum / std::max(score.pairs, 1)));
    }

    std::vector<Score> scores_;
    Score bins_[3];
};

/// "frame,index,t_us,..." of a folder that eventide wrote.
std::vector<long long> times_of(const std::string& folder) {
    std::ifstream file(folder + "/timestamps.csv");
    std::vector<long long> times;
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
        const std::size_t second = line.find(',', line.find(',') + 1);
        times.push_back(std::stoll(line.substr(second + 1)));
    }
    if (times.empty())
        throw eventide::Error(eventide::ErrorKind::input,
                              folder + ": no timestamps.csv with times");
    return times;
}

cv::Mat truth_image(const std::string& folder, std::size_t number) {
    char name[32];
    std::snprintf(name, sizeof name, "/frames/frame_%010zu.png", number);
    cv::Mat image = cv::imread(folder + name, cv::IMREAD_GRAYSCALE);
    if (image.empty())
        throw eventide::Error(eventide::ErrorKind::input, folder + name + ": cannot be read");
    return image;
}

/// Two frames in a row.
class Tracker {
public:
    explicit Tracker(std::string truth_folder) : truth_folder_(std::move(truth_folder)) {}

    void take(const Frame& frame, std::size_t number) {
        const cv::Mat image = as_image(frame);
        if (!before_.empty()) {
            std::vector<Track> tracks = follow(before_, image);
            for (Track& track : tracks)
                track.sigma = std::max(sigma_around(frame_before_, track.from),
                                       sigma_around(frame, track.to));
            if (truth_folder_.empty())
                print(frame, tracks);
            else
                comparison_.add(tracks, truth_image(truth_folder_, number - 1),
                                truth_image(truth_folder_, number));
        }
        before_ = image;
        frame_before_ = frame;
    }
    void end() {
        if (!truth_folder_.empty()) comparison_.print();
    }

private:
    static void print(const Frame& frame, const std::vector<Track>& tracks) {
        Affine motion;
        if (!fit(tracks, weighings()[1].weight, motion)) return;
        const cv::Point2d centre(frame.intensity.width() / 2.0, frame.intensity.height() / 2.0);
        const cv::Point2d step = moved(motion, centre) - centre;
        std::printf("%lld us: %zu corners, the centre moves by %.2f %.2f px\n",
                    static_cast<long long>(eventide::to_us(frame.t)), tracks.size(), step.x,
                    step.y);
    }

    std::string truth_folder_;
    cv::Mat before_;
    Frame frame_before_;
    Comparison comparison_;
};

}  // namespace

int main(int argc, char** argv) try {
    if (argc != 2 && argc != 3)
        throw eventide::Error(eventide::ErrorKind::usage, "tracker RECORDING [TRUTH/]");
    eventide::EventReader reader(argv[1]);
    eventide::Reconstructor reconstructor(
        "default", reader.width(), reader.height(),
        {.window = "auto", .lookahead = 2, .fps = "50", .lamp_flicker = "16ms"});
    const std::vector<long long> truth_times =
        argc == 3 ? times_of(argv[2]) : std::vector<long long>{};
    Tracker tracker(argc == 3 ? argv[2] : "");
    std::size_t next = 1;  // the truth's number 0 lies before the first event
    eventide::Batch batch;
    Frame frame;
    for (bool more = true; more;) {
        more = reader.read(batch);
        reconstructor.push(batch);
        if (!more) reconstructor.finish(reader.clock());
        if (argc == 2)
            for (std::size_t number = 0; reconstructor.next(frame); ++number)
                tracker.take(frame, number);
        for (; next < truth_times.size(); ++next) {
            const auto readiness = reconstructor.readiness(eventide::from_us(truth_times[next]));
            if (readiness == eventide::Readiness::later) break;
            if (readiness == eventide::Readiness::gone) continue;
            reconstructor.render(eventide::from_us(truth_times[next]), frame);
            tracker.take(frame, next);
        }
    }
    tracker.end();
} catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
}
