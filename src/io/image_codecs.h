// Image files as OpenCV reads and writes them. Its library brings a hundred others (GDAL, GDCM,
// OpenEXR) and is loaded at the first call.
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace eventide {

// Thread: any. All throw cv::Exception where OpenCV does, and Error (failed) where the library
// cannot be loaded.

/// Loads the library now, and not when the first frame waits.
void load_image_codecs();

/// cv::imread(): empty where it cannot be read.
cv::Mat read_image(const std::string& path, int flags);

/// cv::imencode(): `extension` begins with a dot; false where it could not be encoded.
bool encode_image(const std::string& extension, const cv::Mat& image,
                  std::vector<unsigned char>& bytes, const std::vector<int>& options = {});

/// cv::haveImageWriter(): by the extension.
bool can_write_image(const std::string& path);

/// Whether a folder's file is one of its images: by the extension, in small letters or capitals.
/// Loads nothing.
bool names_image(const std::filesystem::path& path);

}  // namespace eventide
