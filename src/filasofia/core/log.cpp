#include "filasofia/core/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <mutex>

namespace filasofia {
namespace {

std::mutex sinkMutex;
std::function<void(LogLevel, std::string_view)> userSink;

spdlog::logger& standardError()
{
    static const auto logger = [] {
        auto made =
            std::make_shared<spdlog::logger>("filasofia", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
        made->set_pattern("filasofia: %^%v%$");
        return made;
    }();
    return *logger;
}

spdlog::level::level_enum spdlogLevel(LogLevel level)
{
    switch (level) {
    case LogLevel::Info:
        return spdlog::level::info;
    case LogLevel::Warning:
        return spdlog::level::warn;
    case LogLevel::Error:
        return spdlog::level::err;
    }
    return spdlog::level::err;
}

} // namespace

void writeLog(LogLevel level, std::string_view words)
{
    const std::string line = oneLine(std::string(words));
    const std::lock_guard lock(sinkMutex);
    if (userSink) {
        try {
            userSink(level, line);
        } catch (...) { // a sink that fails must not interrupt the thread that logs
        }
    } else {
        standardError().log(spdlogLevel(level), spdlog::string_view_t(line.data(), line.size()));
    }
}

void setLogSink(std::function<void(LogLevel, std::string_view)> sink)
{
    const std::lock_guard lock(sinkMutex);
    userSink = std::move(sink);
}

} // namespace filasofia
