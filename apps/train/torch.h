// The only way torch comes in: its headers, with the warnings they would raise put aside.
#pragma once

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <torch/torch.h>
#pragma GCC diagnostic pop
