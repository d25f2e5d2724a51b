#include "filasofia/runtime/screenshot_queue.h"

#include "filasofia/core/log.h"
#include "filasofia/runtime/check_file.h"
#include "filasofia/visual/visual_server.h"

#include <filesystem>

namespace filasofia::runtime {
namespace {

/// "filasofia_001.png", or the first number that is free.
std::string freePictureName()
{
    for (int number = 1;; ++number) {
        const std::string digits = std::to_string(number);
        const std::string name =
            text("filasofia_", std::string(3 - std::min<std::size_t>(3, digits.size()), '0'), digits, ".png");
        std::error_code ignored;
        if (!std::filesystem::exists(name, ignored)) return name;
    }
}

} // namespace

void ScreenshotQueue::ask(const std::string& file)
{
    checkFile("run", file, "screenshot", ".png");
    const std::lock_guard lock(mutex_);
    files_.push_back(file);
}

bool ScreenshotQueue::asked() const
{
    const std::lock_guard lock(mutex_);
    return !files_.empty();
}

void ScreenshotQueue::drop(const Error& why)
{
    const std::lock_guard lock(mutex_);
    files_.clear();
    logError("screenshot: ", why.what());
}

void ScreenshotQueue::take(visual::VisualServer& visual, WrittenFiles& written)
{
    std::vector<std::string> files;
    {
        const std::lock_guard lock(mutex_);
        files.swap(files_);
    }
    if (files.empty()) return;
    const visual::Image image = visual.capture();
    for (std::string& file : files) {
        if (file.empty()) file = freePictureName();
        written.savePicture(image, file);
    }
}

} // namespace filasofia::runtime
