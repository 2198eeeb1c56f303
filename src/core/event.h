// Forwards to the public header.
#pragma once

#include <eventide/event.h>
