// A build without windows (-DFILASOFIA_WINDOW=OFF), as the Python package has it: headless runs only.
#include "filasofia/core/error.h"
#include "filasofia/window/window.h"

namespace filasofia::window {
namespace {

constexpr const char* kNone = "this build opens no windows (FILASOFIA_WINDOW=OFF)";

} // namespace

std::unique_ptr<Window> openWindow(const WindowDef& def) { fail("window '", def.title, "': ", kNone); }

bool displayAvailable(std::string* why)
{
    if (why) *why = kNone;
    return false;
}

} // namespace filasofia::window
