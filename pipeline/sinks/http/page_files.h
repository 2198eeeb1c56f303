// The page as it stands in page/, put into the program by config/cmake/embed.cmake.
#pragma once

#include <string_view>

namespace eventide {

extern const std::string_view kPageHtml, kPageCss, kPageJs;

}  // namespace eventide
