// What the shared library shows; everything else in it stays inside.
#pragma once

#define EVENTIDE_API __attribute__((visibility("default")))
