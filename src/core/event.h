// Part of the public face, which is its home.
#pragma once

#include <eventide/event.h>
