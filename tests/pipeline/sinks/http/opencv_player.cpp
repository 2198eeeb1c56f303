// opencv-player URL: reads frames as OpenCV's users do, until a second one that differs, and prints
// the size of each. A program of its own, as video input brings a hundred libraries.
#include <opencv2/videoio.hpp>

#include <cstdio>

int main(int argc, char** argv) {
    cv::VideoCapture capture;
    if (argc != 2 || !capture.open(argv[1], cv::CAP_FFMPEG)) return 1;
    cv::Mat first, frame;
    if (!capture.read(first)) return 2;
    first = first.clone();
    do {
        if (!capture.read(frame) || frame.size() != first.size()) return 3;
    } while (cv::norm(first, frame, cv::NORM_INF) == 0);
    std::printf("%dx%dx%d\n", frame.cols, frame.rows, frame.channels());
    return 0;
}
