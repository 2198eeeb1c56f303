// Images on disk against images on disk: any method's output can be judged.
#include "apps/evaluate/evaluate.h"
#include "apps/evaluate/reference_sequence.h"
#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/io/image_codecs.h"

#include <algorithm>

namespace eventide {
namespace {

namespace fs = std::filesystem;

Array2<float> read_intensity(const fs::path& path) {
    const cv::Mat image = read_image(path.string(), cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH);
    if (image.empty() || (image.depth() != CV_8U && image.depth() != CV_16U))
        throw Error(ErrorKind::input, path.string() + ": expected an image of 8 or 16 bit");
    cv::Mat scaled;
    image.convertTo(scaled, CV_32F, image.depth() == CV_8U ? 1. / 255 : 1. / 65535);
    Array2<float> out(scaled.rows, scaled.cols);
    for (int y = 0; y < scaled.rows; ++y)
        std::copy_n(scaled.ptr<float>(y), scaled.cols, out.row(y).begin());
    return out;
}

std::vector<fs::path> images_in(const fs::path& folder) {
    std::vector<fs::path> found;
    for (const fs::directory_entry& entry : fs::directory_iterator{folder})
        if (entry.is_regular_file() && names_image(entry.path())) found.push_back(entry.path());
    std::ranges::sort(found);
    return found;
}

/// Their names.
std::vector<fs::path> folders_in(const fs::path& folder) {
    std::vector<fs::path> found;
    for (const fs::directory_entry& entry : fs::directory_iterator{folder})
        if (entry.is_directory()) found.push_back(entry.path().filename());
    std::ranges::sort(found);
    return found;
}

SequenceReport compare(const std::string& name, const std::vector<fs::path>& frames,
                       const std::vector<fs::path>& truths, Judge& judge) {
    if (truths.size() != frames.size())
        throw Error(ErrorKind::input, name + ": expected as many images as references, found " +
                                          std::to_string(frames.size()) + " and " +
                                          std::to_string(truths.size()));
    SequenceReport out;
    for (std::size_t i = 0; i < frames.size(); ++i)
        out.frames.push_back(judged(frames[i].string() + " against " + truths[i].string(), judge,
                                    read_intensity(frames[i]), {}, read_intensity(truths[i])));
    out.scores = mean_scores(name, out.frames);
    return out;
}

}  // namespace

EvaluateReport evaluate_folders(const fs::path& frames, const fs::path& references,
                                const fs::path& lpips_file,
                                const std::function<void(const std::string&)>& warn) {
    for (const fs::path& folder : {frames, references})
        if (!fs::is_directory(folder))
            throw Error(ErrorKind::input, folder.string() + ": expected a folder of images");
    const auto lpips = load_lpips(lpips_file);
    Judge judge{lpips.get()};
    EvaluateReport report;
    report.subject = "folders " + frames.string() + " against " + references.string();
    if (lpips) report.lpips_name = lpips->name();
    const auto is_left_out = [&](const fs::path& folder, const fs::path& other) {
        if (fs::is_directory(other)) return false;
        if (warn && !images_in(folder).empty())
            warn(folder.string() + ": is left out, as there is no folder " + other.string());
        return true;
    };
    for (const fs::path& name : folders_in(frames)) is_left_out(frames / name, references / name);
    for (const fs::path& name : folders_in(references)) {
        if (is_left_out(references / name, frames / name)) continue;
        const auto images = images_in(frames / name), truths = images_in(references / name);
        if (!images.empty() || !truths.empty())
            report.sequences.push_back(compare(name.string(), images, truths, judge));
    }
    const auto images = images_in(frames), truths = images_in(references);
    if (!images.empty())
        report.sequences.push_back(compare(sequence_name(frames), images, truths, judge));
    if (report.sequences.empty())
        throw Error(ErrorKind::input, frames.string() + ": expected images, found none");
    if (warn && images.empty() && !truths.empty())
        warn(references.string() + ": " + counted(truths.size(), "image") +
             " beside its folders left out, as " + frames.string() + " has folders alone");
    report.overall = overall_scores(report.sequences);
    return report;
}

}  // namespace eventide
