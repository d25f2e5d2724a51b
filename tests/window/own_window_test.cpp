// A window of the user's own library, which provides no more than it must.
#include "filasofia/core/error.h"
#include "filasofia/window/window.h"
#include "window/x11_person.h"

#include <chrono>
#include <thread>

namespace own_window_test {

using namespace filasofia;
using namespace filasofia::window;

namespace {

/// All that a derived class must have.
class OwnWindow final : public window::Window {
public:
    explicit OwnWindow(void* native) : native_(native) {}
    [[nodiscard]] void* nativeWindow() const override { return native_; }

private:
    void* native_;
};

} // namespace

TEST_CASE("a window that provides only its native window has that one's size, and nobody closes it")
{
    const VirtualDisplay display;
    auto opened = openWindow({.width = 320, .height = 200});
    OwnWindow own(opened->nativeWindow());
    CHECK(own.size() == WindowSize{320, 200});
    CHECK(own.scale() == 1.0);
    CHECK(!own.shouldClose());
    own.setTitle("unheard");
    own.setTextInput(true);
    own.poll([](std::unique_ptr<event::Event>) { FAIL("nothing happens"); });

    Person(opened->nativeWindow()).resize(400, 300);
    for (int i = 0; i < 1000 && own.size() != WindowSize{400, 300}; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    CHECK(own.size() == WindowSize{400, 300});
}

TEST_CASE("the size of a window that is gone, or without a display, is an error and not the end")
{
    {
        const VirtualDisplay display;
        CHECK_THROWS_WITH(OwnWindow(reinterpret_cast<void*>(std::uintptr_t{12345})).size(),
                          "window: size: there is no X11 window 12345");
        CHECK_THROWS_AS(OwnWindow(nullptr).size(), Error);
    }
    const ScopedVariable none("DISPLAY", nullptr);
    CHECK_THROWS_WITH(OwnWindow(nullptr).size(), "window: size: no X display can be opened (DISPLAY)");
}

} // namespace own_window_test
