#include "apps/filasofia/doctor_report.h"
#include "filasofia/core/text.h"
#include "filasofia/visual/gpu.h"

#include <dlfcn.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <initializer_list>

namespace filasofia::app {
namespace {

/// A library opened by name, and closed with this object. It is looked up at run time so that the program also starts
/// without it.
class RuntimeLibrary {
public:
    explicit RuntimeLibrary(const char* name) : handle_(dlopen(name, RTLD_LAZY | RTLD_LOCAL)) {}
    RuntimeLibrary(const RuntimeLibrary&) = delete;
    RuntimeLibrary& operator=(const RuntimeLibrary&) = delete;
    ~RuntimeLibrary()
    {
        if (handle_) dlclose(handle_);
    }
    explicit operator bool() const { return handle_ != nullptr; }
    template <class Function> Function* find(const char* symbol) const
    {
        return handle_ ? reinterpret_cast<Function*>(dlsym(handle_, symbol)) : nullptr;
    }

private:
    void* handle_;
};

std::string environment(const char* name)
{
    const char* value = std::getenv(name);
    return value ? value : "";
}

/// Whether the window system's own library can connect; the connection is closed again.
bool connects(const char* libraryName, const char* openName, const char* closeName)
{
    const RuntimeLibrary library(libraryName);
    const auto open = library.find<void*(const char*)>(openName);
    const auto close = library.find<void(void*)>(closeName);
    void* connection = open && close ? open(nullptr) : nullptr;
    if (!connection) return false;
    close(connection);
    return true;
}

/// "js0 js1 (not readable)": the entries of /dev/input that begin with `prefix`.
Finding inputNodes(std::string name, std::string_view prefix)
{
    Finding finding = {.name = std::move(name)};
    std::vector<std::string> nodes;
    std::error_code ignored; // without /dev/input there are no devices
    for (const auto& entry : std::filesystem::directory_iterator("/dev/input", ignored))
        if (entry.path().filename().string().starts_with(prefix)) nodes.push_back(entry.path().string());
    std::sort(nodes.begin(), nodes.end());
    std::string list;
    for (const std::string& node : nodes) {
        const bool readable = access(node.c_str(), R_OK) == 0;
        list +=
            text(list.empty() ? "" : " ", node.substr(std::strlen("/dev/input/")), readable ? "" : " (not readable)");
        if (!readable) finding.hint = "add yourself to the group 'input' (sudo adduser $USER input) and log in again";
    }
    finding.value = list.empty() ? "none" : list;
    return finding;
}

/// Whether the 3D mouse's daemon answers on its socket.
bool spacenavdAnswers()
{
    const std::string given = environment("SPNAV_SOCKET");
    const std::string path = given.empty() ? "/var/run/spnav.sock" : given;
    sockaddr_un address = {};
    address.sun_family = AF_UNIX;
    if (path.size() >= sizeof address.sun_path) return false;
    std::copy(path.begin(), path.end(), address.sun_path);
    const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (socket < 0) return false;
    const bool answers = connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    close(socket);
    return answers;
}

Finding vendorLibrary(std::string name, std::initializer_list<const char*> files, std::string_view source)
{
    const bool found =
        std::any_of(files.begin(), files.end(), [](const char* file) { return bool(RuntimeLibrary(file)); });
    if (found) return {.name = std::move(name), .value = true};
    return {.name = std::move(name), .value = false, .hint = text("needed only for that device: install ", source)};
}

} // namespace

Section examineGpu()
{
    const visual::GpuReport gpu = visual::probeGpu();
    if (!gpu.available)
        return {
            .title = "gpu",
            .findings = {{.name = "drawing without a window",
                          .value = false,
                          .hint = text(gpu.problem, gpu.problem.empty() ? "" : "; ",
                                       "install libegl1 and libgl1-mesa-dri, or the driver of this machine's GPU")}}};
    return {.title = "gpu",
            .findings = {{.name = "drawing without a window", .value = true},
                         {.name = "software rendering",
                          .value = gpu.software,
                          .hint = gpu.software
                                      ? "the processor draws, which is slow: install the driver of this machine's GPU"
                                      : ""},
                         {.name = "vendor", .value = gpu.vendor},
                         {.name = "renderer", .value = gpu.renderer},
                         {.name = "driver", .value = gpu.version}}};
}

Section examineDisplay()
{
    const std::string x11 = environment("DISPLAY");
    const std::string wayland = environment("WAYLAND_DISPLAY");
    const bool opens =
        (!x11.empty() && connects("libX11.so.6", "XOpenDisplay", "XCloseDisplay")) ||
        (!wayland.empty() && connects("libwayland-client.so.0", "wl_display_connect", "wl_display_disconnect"));
    Finding window = {.name = "a window can open", .value = opens};
    if (!opens)
        window.hint = x11.empty() && wayland.empty()
                          ? "no display: start from a desktop, or run with --headless"
                          : "the display does not answer: check DISPLAY and xhost, or run with --headless";
    return {.title = "display",
            .findings = {{.name = "DISPLAY", .value = x11.empty() ? "not set" : x11},
                         {.name = "WAYLAND_DISPLAY", .value = wayland.empty() ? "not set" : wayland},
                         window}};
}

Section examineDevices()
{
    const bool spacenav = spacenavdAnswers();
    return {.title = "devices",
            .findings = {
                inputNodes("joysticks", "js"),
                inputNodes("input events", "event"),
                {.name = "3D mouse daemon",
                 .value = spacenav,
                 .hint = spacenav ? "" : "needed only for a SpaceNavigator: install spacenavd"},
                vendorLibrary("Force Dimension library", {"libdhd.so.3", "libdhd.so"}, "the Force Dimension SDK"),
                vendorLibrary("OpenHaptics library", {"libHD.so.3.4", "libHD.so"}, "the OpenHaptics SDK"),
            }};
}

} // namespace filasofia::app
