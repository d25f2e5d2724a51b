#pragma once

#include "filasofia/runtime/written_files.h"

#include "filasofia/core/error.h"

#include <mutex>
#include <string>
#include <vector>

namespace filasofia::visual {
class VisualServer;
}

namespace filasofia::runtime {

/// The screenshots that were asked for and are not yet taken.
class ScreenshotQueue {
public:
    /// Asks for a PNG file of the next picture; an empty name means the next free filasofia_001.png. Error if there can
    /// be no such file. Any thread.
    void ask(const std::string& file);
    [[nodiscard]] bool asked() const;
    /// Forgets all screenshots that were asked for and logs why.
    void drop(const Error& why);
    /// Writes the present picture to all files that were asked for. A problem is logged and noted in `written`. Main
    /// thread.
    void take(visual::VisualServer& visual, WrittenFiles& written);

private:
    mutable std::mutex mutex_;
    std::vector<std::string> files_; ///< under the lock
};

} // namespace filasofia::runtime
