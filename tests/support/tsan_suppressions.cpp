// What the thread sanitizer cannot know: ConcurrentQueue synchronises by fences, oneTBB is not
// instrumented. Data that travel through them are still watched: links and pools hand over by
// semaphores.

#if defined(__SANITIZE_THREAD__)
#define EVENTIDE_TSAN 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define EVENTIDE_TSAN 1
#endif
#endif

#ifdef EVENTIDE_TSAN
extern "C" const char* __tsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions() {
    return "race:moodycamel::ConcurrentQueue\n"
           "called_from_lib:libtbb.so\n";
}
#endif
