#pragma once

#include "filasofia/core/text.h"

#include <functional>

namespace filasofia {

enum class LogLevel { Info, Warning, Error };

/// Writes one line to the log (standard error unless a sink was set). Any thread.
void writeLog(LogLevel level, std::string_view line);

/// Sends every line to `sink` instead of standard error; an empty function restores standard error. Any thread.
/// The sink gets one line at a time. It must not log itself; if it throws, the exception is dropped.
void setLogSink(std::function<void(LogLevel, std::string_view)> sink);

template <class... Parts> void logInfo(const Parts&... parts) { writeLog(LogLevel::Info, text(parts...)); }
template <class... Parts> void logWarning(const Parts&... parts) { writeLog(LogLevel::Warning, text(parts...)); }
template <class... Parts> void logError(const Parts&... parts) { writeLog(LogLevel::Error, text(parts...)); }

} // namespace filasofia
