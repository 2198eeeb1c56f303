// What the leak sanitizer finds in others' libraries: fontconfig keeps what it read of its
// configuration until the process ends (Qt asks it for fonts when a window is opened).

// The sanitizer's own name for it; nobody else asks.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libfontconfig.so\n";
}
