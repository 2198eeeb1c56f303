// Forwards to the public header.
#pragma once

#include <eventide/sensor_time.h>
