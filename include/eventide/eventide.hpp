/// @file
/// All of the C++ interface.
#pragma once

#include <eventide/camera.h>
#include <eventide/pipeline.h>
#include <eventide/reader.h>
#include <eventide/reconstructor.h>
#include <eventide/simulation.h>
#include <eventide/version.h>
#include <eventide/writer.h>

#include <eventide/error.h>
