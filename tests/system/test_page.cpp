// The live page as a browser shows it. Skipped where Chromium is not installed.
#include "tests/support/browser.h"
#include "tests/system/program_test.h"

#include <signal.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

namespace eventide::test {
namespace {

using namespace std::chrono_literals;
constexpr std::chrono::seconds kLong{60};  // a busy machine's

/// How many different values are on a canvas, and a number that changes with any of them.
std::string look_at(const std::string& canvas, const std::string& what) {
    return "(() => { const c = document.getElementById('" + canvas +
           "'); const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
           " const values = new Set(d); let sum = 0;"
           " for (let i = 0; i < d.length; ++i) sum = (sum * 31 + d[i]) % 1000000007;"
           " return " +
           what + "; })()";
}

class Page : public ProgramTest {
protected:
    void SetUp() override {
        if (Browser::program().empty())
            GTEST_SKIP() << "chromium is not installed (scripts/install-packages.sh --tests)";
    }

    /// A camera in software, shown at a free port, or at one that was free just now. Its size is
    /// its own on a busy machine, too.
    Process serve(const std::string& port = "0") const {
        return start({"run", "sim:demo?size=64x48", "--model", model(), "--quality", "fixed",
                      "--out", "http:127.0.0.1:" + port});
    }
};

/// The address that the program tells.
std::string address_of(Process& process) {
    for (const auto until = std::chrono::steady_clock::now() + kLong;
         std::chrono::steady_clock::now() < until && process.running();
         std::this_thread::sleep_for(20ms)) {
        const std::string text = process.error_so_far();
        const std::size_t at = text.find("http://");
        if (at != text.npos && text.find('\n', at) != text.npos)
            return text.substr(at, text.find('\n', at) - at);
    }
    throw std::runtime_error("no address: " + process.error_so_far());
}

/// Moves a slider as a hand does.
std::string move(const std::string& control, const std::string& to) {
    return "(() => { const s = document.getElementById('control-" + control +
           "'); s.value = " + to + "; s.dispatchEvent(new Event('input')); return s.value; })()";
}

TEST_F(Page, ShowsFramesThatMove) {
    Process process = serve();
    Browser browser{1280, 900};
    browser.open(address_of(process));
    EXPECT_TRUE(browser.becomes_true("window.eventide && eventide.shown > 3", kLong))
        << browser.value("document.body.innerText");
    EXPECT_EQ(browser.value("document.getElementById('intensity').width"), 64);
    EXPECT_GT(browser.value(look_at("intensity", "values.size")), 8) << "a flat frame";
    EXPECT_GT(browser.value(look_at("sigma", "values.size")), 2);
    EXPECT_TRUE(browser.becomes_true(look_at("events", "values.size > 3"), kLong));
    const auto before = browser.value(look_at("intensity", "sum")).dump();
    EXPECT_TRUE(browser.becomes_true(look_at("intensity", "sum") + " !== " + before, kLong))
        << "the frame stands still";
    EXPECT_EQ(browser.value("document.getElementById('state').innerText"), "live");
    // For people: EVENTIDE_SCREENSHOT=page.png test_page --gtest_filter=*ThatMove
    if (const char* file = std::getenv("EVENTIDE_SCREENSHOT")) browser.screenshot(file);
}

TEST_F(Page, LoadsNothingFromElsewhere) {
    Process process = serve();
    Browser browser{1280, 900};
    const std::string address = address_of(process);
    browser.open(address);
    ASSERT_TRUE(browser.becomes_true("window.eventide && eventide.shown > 3", kLong));
    const auto names = browser.value("performance.getEntriesByType('resource').map(e => e.name)");
    ASSERT_GE(names.size(), 2U);
    for (const std::string name : names)
        EXPECT_TRUE(name.starts_with(address) || name.starts_with("blob:")) << name;
}

TEST_F(Page, SlidersChangeTheRun) {
    Process process = serve();
    Browser browser{1280, 900};
    browser.open(address_of(process));
    ASSERT_TRUE(browser.becomes_true("document.getElementById('control-fps') !== null", kLong));
    // Frames are counted against the sensor's clock, which a busy machine does not change.
    const std::string rate =
        "(async () => { const one = async () => { const n = eventide.shown;"
        " while (eventide.shown === n) await new Promise(r => setTimeout(r, 5));"
        " return [eventide.index, parseFloat(document.getElementById('time').textContent)]; };"
        " const a = await one(), b = await one(); return (b[0] - a[0]) / (b[1] - a[1]); })()";
    EXPECT_NEAR(browser.value(rate).get<double>(), 30, 3);
    browser.value(move("fps", "Math.log(5) / Math.log(1000)"));
    EXPECT_TRUE(browser.becomes_true(rate + ".then(r => r > 4.5 && r < 5.5)", kLong))
        << browser.value(rate);
    browser.value(move("scale", "2"));
    EXPECT_TRUE(browser.becomes_true("document.getElementById('intensity').width === 128", kLong));
    browser.value(move("lookahead", "2"));
    EXPECT_TRUE(browser.becomes_true(
        "eventide.message.controls.find(c => c.name === 'lookahead').value === 2", kLong));
    // The run begins with windows of 20 ms; what a frame says of its own is what the run did.
    const std::string window =
        "parseFloat(document.getElementById('window-events').textContent"
        ".split(' in ')[1])";
    EXPECT_TRUE(browser.becomes_true(window + " === 20", kLong)) << browser.value(window);
    browser.value(move("window", "Math.log(50) / Math.log(500)"));
    EXPECT_TRUE(browser.becomes_true(window + " === 50", kLong)) << browser.value(window);
    EXPECT_EQ(browser.value("document.getElementById('control-speed').hidden"), true)
        << "what cannot be changed is told, and has no slider";
    EXPECT_EQ(browser.value("document.getElementById('refusal').innerText"), "");
}

TEST_F(Page, PauseHoldsTheFrameAndResumeGoesOn) {
    Process process = serve();
    Browser browser{1280, 900};
    browser.open(address_of(process));
    const std::string button = "document.getElementById('pause')";
    ASSERT_TRUE(browser.becomes_true(
        "window.eventide && eventide.shown > 3 && !" + button + ".disabled", kLong));
    browser.value(button + ".click()");
    ASSERT_TRUE(browser.becomes_true(button + ".innerText === 'Resume'", kLong));
    // The newest that was on its way is shown, and after it nothing: two statistics apart.
    const std::string still =
        "(async () => { const now = async () => (await (await fetch('frame.png')).headers)"
        ".get('X-Frame-Index'); return await now() === await now(); })()";
    EXPECT_TRUE(browser.becomes_true(still, kLong));
    const auto held = browser.value("eventide.index").dump();
    browser.value(button + ".click()");
    EXPECT_TRUE(browser.becomes_true("eventide.index > " + held + " + 5", kLong));
}

TEST_F(Page, SurvivesASourceThatIsStartedAgain) {
    Browser browser{1280, 900};
    std::string port;
    {
        Process process = serve();
        const std::string address = address_of(process);
        port = address.substr(address.rfind(':') + 1);
        port.pop_back();  // the slash
        browser.open(address);
        ASSERT_TRUE(browser.becomes_true("window.eventide && eventide.shown > 3", kLong));
        process.signal(SIGINT);
        EXPECT_EQ(process.wait().exit_code, 0);
    }
    EXPECT_TRUE(browser.becomes_true("document.getElementById('notice').hidden === false", kLong));
    const auto shown = browser.value("eventide.shown").dump();
    Process again = serve(port);
    ASSERT_NE(address_of(again), "");
    EXPECT_TRUE(browser.becomes_true("eventide.connections > 1 && eventide.shown > " + shown +
                                         " + 3 && document.getElementById('notice').hidden",
                                     kLong));
    EXPECT_TRUE(
        browser.becomes_true("document.getElementById('state').innerText === 'live'", kLong));
}

}  // namespace
}  // namespace eventide::test
