// What the thread sanitizer cannot know: ConcurrentQueue synchronises by fences. Data that travel
// through it are still watched: links and pools hand over by semaphores. GDAL, by which OpenCV
// reads images, takes two locks of its own in either order, on the one thread that opens a
// recording. GLib, under umockdev's testbeds, locks by futexes, which the sanitizer does not see,
// and so what it hands from thread to thread looks unguarded. cpp-httplib has constants that are
// made with their first use, under a guard that is not seen either. Cyclone DDS counts what its
// threads share by atomics of its own, which are not seen.

// The sanitizer's own name for it; nobody else asks.
extern "C" const char* __tsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions() {
    return "race:moodycamel::ConcurrentQueue\n"
           "deadlock:libgdal.so\n"
           "race:libglib-2.0.so\n"
           "race:libgobject-2.0.so\n"
           "race:libudev.so\n"
           "race:libumockdev\n"
           "race:libddsc.so\n"
           "called_from_lib:libcpp-httplib\n";
}
