// What the leak sanitizer finds in others' libraries: fontconfig keeps what it read of its
// configuration until the process ends (Qt asks it for fonts when a window is opened), Qt its
// offscreen display.

// The sanitizer's own name for it; nobody else asks.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libfontconfig.so\nleak:libqoffscreen.so\nleak:libQt5Gui.so\nleak:libQt5Core.so\n";
}
